// Surface: marching tetrahedra, one cell after the other. See docs/surface.md.
#include "palpate/surface.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <string>

#include "palpate/field.hpp"
#include "surface/nodes.hpp"
#include "surface/refine.hpp"

namespace palpate {
namespace {

using namespace marching;

/// The pass over all cells, x fastest. Of the vertices made so far it keeps those that a later cell
/// can share: the upper faces of the last cell (x), the last row (y) and the last slab (z). An
/// entry is read only where the edge is cut, and the neighbour has written it then, so entries are
/// never cleared.
template <class Nodes>
class Extraction {
  public:
    Extraction(const Field& field, double isovalue, const SampleBox& box,
               std::uint64_t max_vertices, SurfaceMesh& mesh)
        : field_(field),
          nodes_(field, isovalue, box),
          max_vertices_(max_vertices),
          mesh_(mesh),
          low_(box.low),
          cells_(box.high - box.low + Index3::Ones()),
          row_(cells_[0]),
          slab_(static_cast<std::size_t>(cells_[0]) * cells_[1]) {
        // A mirrored grid turns every triangle over.
        mirrored_ = field.geometry().direction.determinant() < 0;
        for (int node = 0; node < node_count; ++node) position_[node] = node_position(node) * 0.5;
    }

    bool run(const std::function<bool(double)>& progress) {
        constexpr int between_reports = 1 << 16;  // cells
        int seen = between_reports;
        for (int k = 0; k < cells_[2]; ++k) {
            for (int j = 0; j < cells_[1]; ++j, seen += cells_[0]) {
                if (seen >= between_reports) {
                    seen = 0;
                    const double slabs = k + static_cast<double>(j) / cells_[1];
                    if (progress && !progress(slabs / cells_[2])) return false;
                }
                for (int i = 0; i < cells_[0]; ++i) visit({i, j, k});
            }
        }
        return !progress || progress(1);
    }

  private:
    using FaceVertices = std::array<std::uint32_t, 8>;  // in the order of Partition::of_face

    /// `at` counts from 0 for the first cell of the box.
    void visit(const Index3& at) {
        if (!nodes_.enter(low_ + at)) return;
        std::array<bool, node_count> solid;
        for (int node = 0; node < node_count; ++node) {
            solid[node] = nodes_.is_solid(static_cast<Node>(node));
        }

        std::array<FaceVertices*, 3> shared{
            &last_, &row_[at[0]], &slab_[at[0] + static_cast<std::size_t>(at[1]) * cells_[0]]};
        std::array<std::uint32_t, edge_count> vertex;
        const auto make = [&](Edge edge) {
            const auto [a, b] = partition.edges[edge];
            vertex[edge] = solid[a] != solid[b] ? add_vertex(at, a, b) : 0;
        };
        std::array<bool, edge_count> known{};
        for (int axis = 0; axis < 3; ++axis) {
            if (at[axis] == 0) continue;
            const auto& face = partition.of_face[axis][0];
            for (int i = 0; i < 8; ++i) {
                vertex[face[i]] = (*shared[axis])[i];
                known[face[i]] = true;
            }
        }
        for (int axis = 0; axis < 3; ++axis) {  // where the box begins there is no neighbour
            if (at[axis] > 0) continue;
            for (const Edge edge : partition.of_face[axis][0]) {
                if (!known[edge]) make(edge);
                known[edge] = true;
            }
        }
        for (const Edge edge : partition.own) make(edge);
        for (int axis = 0; axis < 3; ++axis) {
            const auto& face = partition.of_face[axis][1];
            for (int i = 0; i < 8; ++i) (*shared[axis])[i] = vertex[face[i]];
        }
        add_triangles(solid, vertex);
    }

    std::uint32_t add_vertex(const Index3& at, Node a, Node b) {
        if (mesh_.vertices.size() >= max_vertices_) {
            throw std::length_error("the isosurface has more than " +
                                    std::to_string(max_vertices_) +
                                    " vertices: take another isovalue or a part of the volume");
        }
        const double t = nodes_.crossing(a, b);
        const Vec3 in_cell = position_[a] + t * (position_[b] - position_[a]);
        const Vec3 index = (low_ + at).cast<double>() + Vec3::Constant(Nodes::begin) + in_cell;
        mesh_.vertices.push_back(physical_from_index(field_.geometry(), index));
        return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
    }

    void add_triangles(const std::array<bool, node_count>& solid,
                       const std::array<std::uint32_t, edge_count>& vertex) {
        for (int t = 0; t < tetrahedron_count; ++t) {
            const auto& node = partition.tetrahedra[t];
            unsigned mask = 0;
            for (int i = 0; i < 4; ++i) mask |= unsigned{solid[node[i]]} << i;
            const Cut& cut = partition.cuts[t][mask];
            for (int i = 0; i < cut.triangles; ++i) {
                const Edge* edge = &cut.edges[i == 0 ? 0 : 3];
                std::uint32_t b = vertex[edge[1]];
                std::uint32_t c = vertex[edge[2]];
                if (mirrored_) std::swap(b, c);
                mesh_.triangles.push_back({vertex[edge[0]], b, c});
            }
        }
    }

    const Field& field_;
    Nodes nodes_;
    std::uint64_t max_vertices_;
    SurfaceMesh& mesh_;
    Index3 low_, cells_;
    bool mirrored_ = false;
    std::array<Vec3, node_count> position_;  // [voxel] in the cell
    FaceVertices last_{};
    std::vector<FaceVertices> row_;
    std::vector<FaceVertices> slab_;
};

/// Vertices by a 32-bit index.
constexpr std::uint64_t nameable = std::numeric_limits<std::uint32_t>::max();

template <class Nodes>
SurfaceMesh extract(const Field& field, double isovalue, const SurfaceOptions& options) {
    SurfaceMesh mesh;
    SampleBox box = Nodes::cells(field.geometry());
    if (options.cells) {
        box.low = box.low.cwiseMax(options.cells->low);
        box.high = box.high.cwiseMin(options.cells->high);
        if (box.empty()) return mesh;
    }
    Extraction<Nodes> extraction(field, isovalue, box, std::min(options.max_vertices, nameable),
                                 mesh);
    if (!extraction.run(options.progress)) {
        mesh = {};
        mesh.complete = false;
    }
    return mesh;
}

}  // namespace

SampleBox surface_cells(const Field& field) {
    return field.interpolation() == Interpolation::cubic ? CubicNodes::cells(field.geometry())
                                                         : LinearNodes::cells(field.geometry());
}

SurfaceMesh extract_surface(const Field& field, double isovalue, const SurfaceOptions& options) {
    if (!std::isfinite(isovalue)) throw std::invalid_argument("the isovalue is not finite");
    if (!(options.tolerance >= 0)) throw std::invalid_argument("a tolerance is 0 or more");
    if (field.interpolation() == Interpolation::linear) {
        return extract<LinearNodes>(field, isovalue, options);
    }
    SurfaceMesh mesh = extract<CubicNodes>(field, isovalue, options);
    const auto add_normals = [&] {
        mesh.normals.reserve(mesh.vertices.size());
        for (const Vec3& vertex : mesh.vertices) {
            constexpr std::size_t between_reports = 4096;
            const bool report = mesh.normals.size() % between_reports == 0 && options.progress;
            if (report && !options.progress(1)) return false;
            mesh.normals.emplace_back(-field.sign() *
                                      gradient_at(field, vertex).stableNormalized());
        }
        return true;
    };
    const double tolerance = options.tolerance * field.geometry().spacing.minCoeff();
    const bool whole = mesh.complete &&
                       (!(tolerance > 0) || refine(mesh, field, isovalue, tolerance, options)) &&
                       (!options.normals || add_normals());
    if (!whole) {
        mesh = {};
        mesh.complete = false;
    }
    return mesh;
}

double enclosed_volume(const SurfaceMesh& mesh) {
    if (mesh.vertices.empty()) return 0;
    // Relative to a vertex of the mesh, so that bodies far from the origin lose no digits.
    const Vec3 from = mesh.vertices.front();
    double six_times = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 p = mesh.vertices[a] - from;
        six_times += p.dot((mesh.vertices[b] - from).cross(mesh.vertices[c] - from));
    }
    return six_times / 6;
}

}  // namespace palpate
