// Surface: marching tetrahedra, one cell after the other. See docs/surface.md.
//
// A cell has 15 nodes (0-7 its corners, 8-13 the centres of its faces, 14 its own) and 50 edges
// between them. 29 edges are the cell's own; the other 21 lie on its three lower faces, and the
// neighbouring cells there have handled them.
#include "palpate/surface.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <string>

namespace palpate {
namespace {

constexpr int node_count = 15;
constexpr int edge_count = 50;
constexpr int own_count = 29;
constexpr int tetrahedron_count = 24;
constexpr int centre_node = 14;
constexpr int face_node(int axis, int side) {
    return 8 + 2 * axis + side;
}

using Node = std::uint8_t;
using Edge = std::uint8_t;

/// Corner q (0-3) of a face; the same q lies opposite on both sides of the cell.
constexpr int corner_of_face(int axis, int side, int q) {
    const int low = (1 << axis) - 1;
    return (q & low) | side << axis | (q & ~low) << 1;
}

/// The triangles of the isosurface in one tetrahedron.
struct Piece {
    std::uint8_t triangles = 0;  // 0, 1 or 2
    std::array<Edge, 6> edges{};
};

/// The partition of a cell.
struct Partition {
    std::array<std::array<Node, 2>, edge_count> edges{};
    std::array<std::array<std::array<Edge, 8>, 2>, 3> of_face{};  // [axis][side], matching order
    std::array<Edge, own_count> own{};  // edges on none of the lower faces
    std::array<std::array<Node, 4>, tetrahedron_count> tetrahedra{};  // all of one handedness
    std::array<std::array<Piece, 16>, tetrahedron_count> pieces{};
    std::array<std::array<Edge, node_count>, node_count> between{};
};

constexpr void add_edges(Partition& p) {
    int count = 0;
    const auto edge = [&](int a, int b) {
        if (p.between[a][b] == edge_count) {
            p.edges[count] = {static_cast<Node>(a), static_cast<Node>(b)};
            p.between[a][b] = p.between[b][a] = static_cast<Edge>(count++);
        }
        return p.between[a][b];
    };
    for (auto& row : p.between) row.fill(edge_count);
    for (int side = 0; side < 2; ++side) {  // lower faces first: their 21 edges get the low numbers
        for (int axis = 0; axis < 3; ++axis) {
            auto& face = p.of_face[axis][side];
            const auto corner = [&](int q) { return corner_of_face(axis, side, q); };
            face[0] = edge(corner(0), corner(1));
            face[1] = edge(corner(2), corner(3));
            face[2] = edge(corner(0), corner(2));
            face[3] = edge(corner(1), corner(3));
            for (int q = 0; q < 4; ++q) face[4 + q] = edge(corner(q), face_node(axis, side));
        }
    }
    for (int node = 0; node < centre_node; ++node) edge(node, centre_node);
    for (int i = 0; i < own_count; ++i) p.own[i] = static_cast<Edge>(edge_count - own_count + i);
}

constexpr void add_tetrahedra(Partition& p) {
    int count = 0;
    for (int d = 0; d < 3; ++d) {
        for (int s = 0; s < 3; ++s) {
            if (s == d) continue;
            const int e = 3 - d - s;
            for (int sides = 0; sides < 4; ++sides) {
                const int minus = (sides & 1) << d | (sides >> 1) << s;
                const int plus = minus | 1 << e;
                const int face = face_node(d, sides & 1);
                // det(face, minus, plus) from the centre is 2 sign_d sign_s det(d, s, e).
                const bool right_handed =
                    ((s - d + 3) % 3 == 1) == (((sides & 1) != 0) == ((sides >> 1) != 0));
                p.tetrahedra[count++] = {static_cast<Node>(centre_node), static_cast<Node>(face),
                                         static_cast<Node>(right_handed ? minus : plus),
                                         static_cast<Node>(right_handed ? plus : minus)};
            }
        }
    }
}

/// The cut of a tetrahedron of the cell, as triangles. All tetrahedra are right-handed.
constexpr Piece piece_of(const Partition& p, const std::array<Node, 4>& node, unsigned solid) {
    const TetrahedronCut cut = cut_of(solid);
    if (cut.count == 0) return {};
    std::array<Edge, 4> edges{};
    for (int i = 0; i < cut.count; ++i) {
        edges[i] = p.between[node[cut.edges[i].solid]][node[cut.edges[i].free]];
    }
    const auto [a, b, c, d] = edges;
    if (cut.count == 3) return {1, {a, b, c}};
    return {2, {a, b, c, a, c, d}};
}

constexpr Partition cut_cell() {
    Partition p;
    add_edges(p);
    add_tetrahedra(p);
    for (int t = 0; t < tetrahedron_count; ++t) {
        for (unsigned solid = 0; solid < 16; ++solid) {
            p.pieces[t][solid] = piece_of(p, p.tetrahedra[t], solid);
        }
    }
    return p;
}

constexpr Partition partition = cut_cell();

/// Position of a node in its cell, in half voxels.
Vec3 node_position(int node) {
    if (node == centre_node) return {1, 1, 1};
    if (node < 8) return Vec3(node & 1, node >> 1 & 1, node >> 2 & 1) * 2;
    Vec3 at(1, 1, 1);
    at[(node - 8) / 2] = 2 * (node & 1);
    return at;
}

/// Values of the nodes. All cells that share a node compute the same bits, because they add the
/// face's corners in the same order from both sides.
std::array<double, node_count> node_values(const CellSamples& f) {
    std::array<double, node_count> value;
    for (int corner = 0; corner < 8; ++corner) value[corner] = f[corner];
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            const auto at = [&](int q) { return f[corner_of_face(axis, side, q)]; };
            value[face_node(axis, side)] = ((at(0) + at(1)) + (at(2) + at(3))) * 0.25;
        }
    }
    value[centre_node] =
        (((f[0] + f[1]) + (f[2] + f[3])) + ((f[4] + f[5]) + (f[6] + f[7]))) * 0.125;
    return value;
}

/// The pass over all cells, x fastest. Of the vertices made so far it keeps those that a later cell
/// can share: the upper faces of the last cell (x), the last row (y) and the last slab (z). An
/// entry is read only where the edge is cut, and the neighbour has written it then, so entries are
/// never cleared.
class Extraction {
  public:
    Extraction(const Field& field, double isovalue, const SampleBox& box,
               std::uint64_t max_vertices, SurfaceMesh& mesh)
        : field_(field),
          isovalue_(isovalue - field.offset()),
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
        for (int k = 0; k < cells_[2]; ++k) {
            if (progress && !progress(static_cast<double>(k) / cells_[2])) return false;
            for (int j = 0; j < cells_[1]; ++j) {
                for (int i = 0; i < cells_[0]; ++i) visit({i, j, k});
            }
        }
        return !progress || progress(1);
    }

  private:
    using FaceVertices = std::array<std::uint32_t, 8>;  // in the order of Partition::of_face

    bool is_solid(double value) const { return field_.sign() * (value - isovalue_) > 0; }

    /// `at` counts from 0 for the first cell of the box.
    void visit(const Index3& at) {
        const CellSamples samples = field_.cell(low_ + at);
        int solid_corners = 0;
        for (const double value : samples) solid_corners += is_solid(value);
        // Rounded means stay between the least and the greatest sample: no node can differ.
        if (solid_corners == 0 || solid_corners == 8) return;

        const auto value = node_values(samples);
        std::array<bool, node_count> solid;
        for (int node = 0; node < node_count; ++node) solid[node] = is_solid(value[node]);

        std::array<FaceVertices*, 3> shared{
            &last_, &row_[at[0]], &slab_[at[0] + static_cast<std::size_t>(at[1]) * cells_[0]]};
        std::array<std::uint32_t, edge_count> vertex;
        const auto make = [&](Edge edge) {
            const auto [a, b] = partition.edges[edge];
            vertex[edge] = solid[a] != solid[b] ? add_vertex(at, a, b, value) : 0;
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

    std::uint32_t add_vertex(const Index3& at, Node a, Node b,
                             const std::array<double, node_count>& value) {
        if (mesh_.vertices.size() >= max_vertices_) {
            throw std::length_error("the isosurface has more than " +
                                    std::to_string(max_vertices_) +
                                    " vertices: take another isovalue or a part of the volume");
        }
        double t = (isovalue_ - value[a]) / (value[b] - value[a]);
        if (!(t > surface_margin)) t = surface_margin;
        if (t > 1 - surface_margin) t = 1 - surface_margin;
        const Vec3 in_cell = position_[a] + t * (position_[b] - position_[a]);
        const Vec3 index = (low_ + at).cast<double>() + in_cell;
        mesh_.vertices.push_back(physical_from_index(field_.geometry(), index));
        return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
    }

    void add_triangles(const std::array<bool, node_count>& solid,
                       const std::array<std::uint32_t, edge_count>& vertex) {
        for (int t = 0; t < tetrahedron_count; ++t) {
            const auto& node = partition.tetrahedra[t];
            unsigned mask = 0;
            for (int i = 0; i < 4; ++i) mask |= unsigned{solid[node[i]]} << i;
            const Piece& piece = partition.pieces[t][mask];
            for (int i = 0; i < piece.triangles; ++i) {
                const Edge* edge = &piece.edges[i == 0 ? 0 : 3];
                std::uint32_t b = vertex[edge[1]];
                std::uint32_t c = vertex[edge[2]];
                if (mirrored_) std::swap(b, c);
                mesh_.triangles.push_back({vertex[edge[0]], b, c});
            }
        }
    }

    const Field& field_;
    double isovalue_;  // less the field's offset, like its cells
    std::uint64_t max_vertices_;
    SurfaceMesh& mesh_;
    Index3 low_, cells_;
    bool mirrored_ = false;
    std::array<Vec3, node_count> position_;  // [voxel] in the cell
    FaceVertices last_{};
    std::vector<FaceVertices> row_;
    std::vector<FaceVertices> slab_;
};

}  // namespace

SurfaceMesh extract_surface(const Field& field, double isovalue, const SurfaceOptions& options) {
    if (!std::isfinite(isovalue)) throw std::invalid_argument("the isovalue is not finite");
    const std::uint64_t nameable = std::numeric_limits<std::uint32_t>::max();
    SurfaceMesh mesh;
    // The cells that touch the grid: one sample before it is background.
    SampleBox box{Index3::Constant(-1), field.geometry().size - Index3::Ones()};
    if (options.cells) {
        box.low = box.low.cwiseMax(options.cells->low);
        box.high = box.high.cwiseMin(options.cells->high);
        if (box.empty()) return mesh;
    }
    Extraction extraction(field, isovalue, box, std::min(options.max_vertices, nameable), mesh);
    if (!extraction.run(options.progress)) {
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
