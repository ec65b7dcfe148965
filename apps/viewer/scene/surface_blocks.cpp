// Extracts blocks from copies of their samples, in index space, with one more cell on every side,
// so that normals at a border include the neighbouring facets. Renews outdated ones on several
// threads.
#include "apps/viewer/scene/surface_blocks.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/model/worker.hpp"
#include "palpate/field.hpp"
#include "palpate/surface.hpp"
#include "pictures/surface.hpp"

namespace palpate::viewer {
namespace {

using Eigen::Vector3f;

/// The differences over a sample to either side, in index space: smoother than the facets of the
/// lattice. A cubic field is smooth itself.
Vec3 slope_at(const Field& field, const Vec3& p) {
    if (field.interpolation() == Interpolation::cubic) return gradient_at(field, p);
    Vec3 slope;
    for (int a = 0; a < 3; ++a) {
        const Vec3 step = Vec3::Unit(a);
        slope[a] = value_at(field, Vec3(p + step)) - value_at(field, Vec3(p - step));
    }
    return slope;
}

Index3 cell_of(const Vec3& index) {
    return index.array().floor().cast<int>();
}

bool one_sided(const std::vector<float>& values, const Field& field, double isovalue) {
    const auto solid = [&](float v) { return field.sign() * (double(v) - isovalue) > 0; };
    const auto [low, high] = std::ranges::minmax(values);
    return solid(low) == solid(high);
}

/// The triangles in the block's own cells: one with all of its middle in the cell that it lies in.
/// A cell begins `begin` from its index.
void drop_neighbours(SurfaceMesh& mesh, const Index3& low, int edge, double begin) {
    const Index3 last = low + Index3::Constant(edge - 1);
    std::erase_if(mesh.triangles, [&](const auto& t) {
        const Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
        const Index3 cell = cell_of(middle - Vec3::Constant(begin));
        return (cell.array() < low.array()).any() || (cell.array() > last.array()).any();
    });
}

/// From index space to where it is drawn: physical axes, from `middle`.
struct Placing {
    Mat3 direction;
    Vec3 spacing, origin;

    Placing(const Geometry& g, const Vec3& middle)
        : direction(g.direction), spacing(g.spacing), origin(g.origin - middle) {}
    Vec3 operator()(const Vec3& index) const {
        return origin + direction * spacing.cwiseProduct(index);
    }
};

/// Normals of the vertices of a mesh in index space, weighted by the areas of the facets around.
std::vector<Vector3f> facet_normals(SurfaceMesh mesh, const Placing& place) {
    for (Vec3& v : mesh.vertices) v = place(v);
    return pictures::mesh_normals(mesh);
}

Vec3 drawn_together(const Vec3& index, const GridEnds& ends) {
    const Vec3 inside = index.cwiseMax(0).cwiseMin(ends.last);
    const Vec3 before = index.cwiseMin(0), behind = (index - ends.last).cwiseMax(0);
    return inside + ends.before * before + behind.cwiseProduct(ends.behind);
}

/// `reach`: closing_samples().
GridEnds ends_of(const Index3& size, int every, int reach) {
    GridEnds ends;
    ends.last = (size - Index3::Ones()).cast<double>() / every;
    ends.before = 1.0 / every;
    for (int a = 0; a < 3; ++a) {
        const double end = coarse_size(size, every)[a] - 1 + reach;  // of the coarse field
        ends.behind[a] = double(reach) / every / (end - ends.last[a]);
    }
    return ends;
}

}  // namespace

std::shared_ptr<const RenderMesh> block_mesh(const Field& field, double isovalue,
                                             const Index3& cell, int edge, const Vec3& middle,
                                             const GridEnds& ends) {
    // One more cell on every side. A cubic one, around a sample, has samples on both sides.
    const bool is_smooth = field.interpolation() == Interpolation::cubic;
    const int more = is_smooth ? 2 : 1;
    const double begin = is_smooth ? -0.5 : 0;
    const Index3 around = cell - Index3::Constant(more);
    const Index3 size = Index3::Constant(edge + (is_smooth ? 4 : 3));
    std::vector<float> samples = sample_block(field, around, size);
    if (one_sided(samples, field, isovalue)) return nullptr;

    // In index space, so that a vertex between two blocks is the same number in both.
    const Field local(Volume({size, Vec3::Ones(), around.cast<double>()}, std::move(samples)),
                      field.solid(), field.background(), field.interpolation());
    SurfaceOptions options;
    options.cells = SampleBox{Index3::Constant(more - 1), Index3::Constant(edge + more)};
    SurfaceMesh mesh = extract_surface(local, isovalue, options);
    if (field.geometry().direction.determinant() < 0) {
        for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    }
    const Placing place(field.geometry(), middle);
    const std::vector<Vector3f> facets = facet_normals(mesh, place);
    drop_neighbours(mesh, cell, edge, begin);
    if (mesh.triangles.empty()) return nullptr;

    auto block = std::make_shared<RenderMesh>();
    block->triangles.reserve(3 * mesh.triangles.size());
    const auto add_vertex = [&](std::uint32_t v) {
        const Vec3& index = mesh.vertices[v];
        const Vec3 slope = place.direction * slope_at(local, index).cwiseQuotient(place.spacing);
        // The facet's normal, if the slope is zero (plateaus) or misleading (thin sheets).
        const Vector3f smooth = (-field.sign() * slope).normalized().cast<float>();
        const Vector3f normal = smooth.dot(facets[v]) > 0.3F ? smooth : facets[v];
        const Vector3f position = place(drawn_together(index, ends)).cast<float>();
        block->positions.insert(block->positions.end(), position.begin(), position.end());
        block->normals.insert(block->normals.end(), normal.begin(), normal.end());
    };
    std::vector<std::int32_t> number(mesh.vertices.size(), -1);
    for (const auto& t : mesh.triangles) {
        for (const std::uint32_t v : t) {
            if (number[v] < 0) {
                number[v] = static_cast<std::int32_t>(block->vertex_count());
                add_vertex(v);
            }
            block->triangles.push_back(number[v]);
        }
    }
    block->positions.shrink_to_fit();
    block->normals.shrink_to_fit();
    return block;
}

SurfaceBlocks::SurfaceBlocks(const Geometry& geometry, int every, Interpolation interpolation,
                             const Vec3& origin)
    : geometry_(geometry), every_(every), origin_(origin), reach_(closing_samples(interpolation)) {
    // The cells of the ring count: from -1 to the last sample; round samples, to one after it.
    const Index3 cells_there = coarse_size(geometry.size, every) + Index3::Constant(reach_);
    count_ = (cells_there.array() + cells - 1) / cells;
    const auto blocks = static_cast<std::size_t>(count_.cast<std::int64_t>().prod());
    meshes_.resize(blocks);
    fresh_.resize(blocks, 0);
}

Index3 SurfaceBlocks::first_cell(std::size_t block) const {
    const auto b = static_cast<int>(block);
    const Index3 at(b % count_[0], b / count_[0] % count_[1], b / (count_[0] * count_[1]));
    return at * cells - Index3::Ones();
}

void SurfaceBlocks::mark(const SampleBox& changed) {
    if (changed.empty()) return;
    Index3 low, high;
    for (int a = 0; a < 3; ++a) {
        // Samples of the coarse grid; a block looks at those from one before its first cell (two
        // on a cubic field) to two after its last.
        const SampleBox part = coarse_part(changed, geometry_.size, every_);
        const int first = part.low[a], last = part.high[a] + (reach_ - 1);
        if (last < first || changed.high[a] < 0) return;
        low[a] = std::max(0, (first - cells) / cells);
        while ((low[a] + 1) * cells < first) ++low[a];  // its last sample: low * cells + cells
        high[a] = std::min(count_[a] - 1, (last + 2) / cells);
    }
    for (int k = low[2]; k <= high[2]; ++k) {
        for (int j = low[1]; j <= high[1]; ++j) {
            for (int i = low[0]; i <= high[0]; ++i) {
                fresh_[(static_cast<std::size_t>(k) * count_[1] + j) * count_[0] + i] = 0;
            }
        }
    }
}

std::size_t SurfaceBlocks::outdated() const {
    return static_cast<std::size_t>(std::ranges::count(fresh_, 0));
}

SurfaceBlocks::Outcome SurfaceBlocks::renew(const Field& field, double isovalue,
                                            const std::function<bool()>& go_on,
                                            std::size_t most_triangles) {
    const GridEnds ends = ends_of(geometry_.size, every_, reach_);
    std::atomic<std::size_t> triangles{triangle_count(meshes_)};
    std::atomic<bool> too_many{false};
    std::vector<std::size_t> outdated;
    for (std::size_t b = 0; b < fresh_.size(); ++b) {
        if (fresh_[b] == 0) outdated.push_back(b);
    }
    const bool all = for_each_at_once(outdated, [&](std::size_t b) {
        if (!go_on()) return false;
        auto mesh = block_mesh(field, isovalue, first_cell(b), cells, origin_, ends);
        const auto count = [](const auto& m) { return m ? m->triangle_count() : 0; };
        triangles += count(mesh) - count(meshes_[b]);
        meshes_[b] = std::move(mesh);
        fresh_[b] = 1;
        if (triangles > most_triangles) too_many = true;
        return !too_many;
    });
    if (too_many) return Outcome::too_many;
    return all ? Outcome::done : Outcome::interrupted;
}

}  // namespace palpate::viewer
