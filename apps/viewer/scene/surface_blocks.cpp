// Extracts blocks from copies of their samples, in index space, with one more cell on every side,
// so that normals at a border include the neighbouring facets. Renews outdated ones on several
// threads.
#include "apps/viewer/scene/surface_blocks.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/model/worker.hpp"
#include "palpate/field.hpp"
#include "palpate/surface.hpp"
#include "pictures/surface.hpp"

namespace palpate::viewer {
namespace {

using Eigen::Vector3f;

/// The samples at the corners of the cells `first` to `first` + `size` - 2.
struct Corners {
    Index3 first, size;
    std::vector<float> values;

    float at(const Index3& i) const {
        const Index3 in = i - first;
        return values[(static_cast<std::size_t>(in[2]) * size[1] + in[1]) * size[0] + in[0]];
    }
    /// Central differences at a sample, per sample.
    Vec3 slope(const Index3& i) const {
        Vec3 slope;
        for (int a = 0; a < 3; ++a) {
            Index3 high = i, low = i;
            ++high[a];
            --low[a];
            slope[a] = 0.5 * (double(at(high)) - double(at(low)));
        }
        return slope;
    }
};

/// The differences of the lattice's field over a voxel to either side, per sample, at a point in
/// index space: since the lattice is the same in every cell, its interpolation of the samples'.
Vec3 slope_at(const Corners& corners, const Vec3& p, const Index3& cell) {
    const Vec3 from_centre = p - (cell.cast<double>() + Vec3::Constant(0.5));
    std::array<int, 3> axis{0, 1, 2};  // the longest way first
    const auto longer = [&](int a, int b) {
        return std::abs(from_centre[a]) > std::abs(from_centre[b]);
    };
    if (longer(axis[1], axis[0])) std::swap(axis[0], axis[1]);
    if (longer(axis[2], axis[1])) std::swap(axis[1], axis[2]);
    if (longer(axis[1], axis[0])) std::swap(axis[0], axis[1]);
    const auto [d, s, e] = axis;
    std::array<Vec3, 8> g;
    for (int c = 0; c < 8; ++c) {
        g[static_cast<std::size_t>(c)] =
            corners.slope(cell + Index3(c & 1, c >> 1 & 1, c >> 2 & 1));
    }
    Vec3 centre = Vec3::Zero(), face = Vec3::Zero();
    const int side = from_centre[d] > 0 ? 1 : 0;
    for (int c = 0; c < 8; ++c) {
        centre += 0.125 * g[static_cast<std::size_t>(c)];
        if ((c >> d & 1) == side) face += 0.25 * g[static_cast<std::size_t>(c)];
    }
    const int minus = side << d | (from_centre[s] > 0 ? 1 : 0) << s, plus = minus | 1 << e;
    const double far = std::abs(from_centre[d]), middle = std::abs(from_centre[s]);
    return (1 - 2 * far) * centre + 2 * (far - middle) * face +
           (middle - from_centre[e]) * g[static_cast<std::size_t>(minus)] +
           (middle + from_centre[e]) * g[static_cast<std::size_t>(plus)];
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

/// On which sides of the block: 2 bits an axis.
std::uint8_t seams_of(const Vec3& index, const Vec3& low, int edge) {
    int seams = 0;
    for (int a = 0; a < 3; ++a) {
        if (index[a] == low[a]) seams |= 1 << (2 * a);
        if (index[a] == low[a] + edge) seams |= 2 << (2 * a);
    }
    return static_cast<std::uint8_t>(seams);
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

/// Of each vertex of the mesh in index space, by the area of the facets round it.
std::vector<Vector3f> facet_normals(SurfaceMesh mesh, const Placing& place) {
    for (Vec3& v : mesh.vertices) v = place(v);
    return pictures::mesh_normals(mesh);
}

}  // namespace

std::shared_ptr<const RenderMesh> block_mesh(const Field& field, double isovalue,
                                             const Index3& cell, int edge, const Vec3& middle,
                                             const SurfaceBounds& bounds) {
    // One more cell on every side; a cubic one, round a sample, has samples on both sides.
    const bool is_smooth = field.interpolation() == Interpolation::cubic;
    const int more = is_smooth ? 2 : 1;
    const double begin = is_smooth ? -0.5 : 0;
    const Index3 around = cell - Index3::Constant(more);
    const Index3 size = Index3::Constant(edge + (is_smooth ? 4 : 3));
    const Corners corners{around, size, sample_block(field, around, size)};
    if (one_sided(corners.values, field, isovalue)) return nullptr;

    // In index space, so that a vertex between two blocks is the same number in both.
    const Field local(Volume({size, Vec3::Ones(), around.cast<double>()}, corners.values),
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
    const Index3 last = cell + Index3::Constant(edge - 1);
    const auto add_vertex = [&](std::uint32_t v) {
        const Vec3& index = mesh.vertices[v];
        const Index3 in = cell_of(index).cwiseMax(cell).cwiseMin(last);
        // The copy's physical space is index space.
        const Vec3 per_sample =
            is_smooth ? gradient_at(local, index) : slope_at(corners, index, in);
        const Vec3 slope = place.direction * per_sample.cwiseQuotient(place.spacing);
        // The facet's where the slope says nothing (plateaus) or something else (thin sheets).
        const Vector3f smooth = (-field.sign() * slope).normalized().cast<float>();
        const Vector3f normal = smooth.dot(facets[v]) > 0.3F ? smooth : facets[v];
        const Vector3f position =
            place(index.cwiseMax(bounds.low).cwiseMin(bounds.high)).cast<float>();
        block->positions.insert(block->positions.end(), position.begin(), position.end());
        block->normals.insert(block->normals.end(), normal.begin(), normal.end());
        block->seams.push_back(seams_of(index, cell.cast<double>() + Vec3::Constant(begin), edge));
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
    block->seams.shrink_to_fit();
    return block;
}

namespace {

std::vector<std::size_t> zeros_of(const std::vector<std::uint8_t>& flags) {
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < flags.size(); ++i) {
        if (flags[i] == 0) places.push_back(i);
    }
    return places;
}

}  // namespace

SurfaceBlocks::SurfaceBlocks(const Geometry& geometry, int every, Interpolation interpolation,
                             const Vec3& origin)
    : geometry_(geometry),
      every_(every),
      origin_(origin),
      reach_(interpolation == Interpolation::cubic ? 2 : 1) {
    // The cells of the ring count: from -1 to the last sample; round samples, to one after it.
    const Index3 cells_there = coarse_size(geometry.size, every) + Index3::Constant(reach_);
    count_ = (cells_there.array() + cells - 1) / cells;
    const auto blocks = static_cast<std::size_t>(count_.cast<std::int64_t>().prod());
    meshes_.resize(blocks);
    simple_.resize(blocks);
    fresh_.resize(blocks, 0);
    fresh_simple_.resize(blocks, 0);
    area_.resize(blocks, 0);
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
    // As far out of the full grid as its own surface can be.
    const SurfaceBounds bounds{Vec3::Constant(double(-reach_) / every_),
                               (geometry_.size.array() + (reach_ - 1)).cast<double>() / every_};
    std::atomic<std::size_t> triangles{triangle_count(meshes_)};
    std::atomic<bool> too_many{false};
    const bool all = for_each_at_once(zeros_of(fresh_), [&](std::size_t b) {
        if (!go_on()) return false;
        auto mesh = block_mesh(field, isovalue, first_cell(b), cells, origin_, bounds);
        const auto count = [](const auto& m) { return m ? m->triangle_count() : 0; };
        triangles += count(mesh) - count(meshes_[b]);
        meshes_[b] = std::move(mesh);
        area_[b] = meshes_[b] ? area_of(*meshes_[b]) : 0;
        fresh_[b] = 1;
        fresh_simple_[b] = 0;
        if (triangles > most_triangles) too_many = true;
        return !too_many;
    });
    if (too_many) return Outcome::too_many;
    return all ? Outcome::done : Outcome::interrupted;
}

/// Simplifies the blocks that are outdated. False if there are still too many triangles.
bool SurfaceBlocks::simplify(std::size_t most_triangles, double slack) {
    for_each_at_once(zeros_of(fresh_simple_), [&](std::size_t b) {
        simple_[b] = nullptr;
        if (meshes_[b]) {
            simple_[b] = std::make_shared<const RenderMesh>(
                clustered(*meshes_[b], static_cast<float>(grain_)));
        }
        fresh_simple_[b] = 1;
        return true;
    });
    return double(triangle_count(simple_)) <= slack * double(most_triangles);
}

std::shared_ptr<const RenderMesh> SurfaceBlocks::simplified(std::size_t most_triangles) {
    const auto refresh_all = [&] { std::ranges::fill(fresh_simple_, std::uint8_t{0}); };
    if (triangle_count(meshes_) <= most_triangles) {
        simple_.assign(simple_.size(), nullptr);
        refresh_all();
        grain_ = 0;
        return joined(meshes_);
    }
    // A surface that grows may have half as many again before all of it is made coarser.
    if (grain_ > 0 && simplify(most_triangles, 1.5)) return joined(simple_);
    const double most = static_cast<double>(std::max<std::size_t>(most_triangles, 1));
    if (grain_ == 0) {
        double area = 0;
        for (const double a : area_) area += a;
        // About three triangles a box that the surface goes through, and more where blocks meet.
        grain_ = 1.2 * std::sqrt(3 * area / most);
        refresh_all();
        if (simplify(most_triangles, 1.25)) return joined(simple_);
    }
    const double widest = 0.5 * cells * every_ * geometry_.spacing.minCoeff();
    while (grain_ < widest) {
        grain_ *= std::max(1.1, std::sqrt(double(triangle_count(simple_)) / most));
        refresh_all();
        if (simplify(most_triangles, 1.25)) return joined(simple_);
    }
    // Of noise even the coarsest blocks are too many: the seams between them go, too.
    const auto coarse = joined(simple_);
    return std::make_shared<const RenderMesh>(viewer::simplified(*coarse, most_triangles));
}

}  // namespace palpate::viewer
