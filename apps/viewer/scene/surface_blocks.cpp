// Renews outdated blocks on several threads.
#include "apps/viewer/scene/surface_blocks.hpp"

#include <algorithm>
#include <cmath>

#include "apps/viewer/model/at_once.hpp"
#include "apps/viewer/model/coarse_samples.hpp"
#include "apps/viewer/scene/block_mesh.hpp"

namespace palpate::viewer {
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
