// Chooses levels and boxes of a store for pictures.
#include "apps/viewer/model/detail_choice.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::viewer {
namespace {

/// A sample may be so many pixels wide before a finer level is worth it.
constexpr double coarse_enough = 1.4;
/// Of what is seen of a slice, beyond each edge.
constexpr double wider = 0.25;
/// Layers of a slice's box: at least those that a smooth field needs, at most this many.
constexpr int fewest_layers = 4, most_layers = 16;
/// Levels from one that is read to the next finer one.
constexpr int stride = 2;

const stream::Level& level_of(const SeenStore& store, int level) {
    return store.info->levels[static_cast<std::size_t>(level)];
}

struct Cost {
    std::int64_t samples, pieces;
    double bytes;
};

Cost cost_of(const stream::Level& level, SampleType type, const SampleBox& box) {
    const auto each = static_cast<double>(size_of(type));
    const Index3 size = box.high - box.low + Index3::Ones();
    Cost cost{size.cast<std::int64_t>().prod(), 0, 0};
    const bool is_row = level.chunk[1] == 1 && level.chunk[2] == 1;
    if (is_row) {
        cost.pieces = std::int64_t{size[1]} * size[2];
        cost.bytes = static_cast<double>(cost.samples) * each;
        return cost;
    }
    const Index3 pieces =
        box.high.cwiseQuotient(level.chunk) - box.low.cwiseQuotient(level.chunk) + Index3::Ones();
    cost.pieces = pieces.cast<std::int64_t>().prod();
    cost.bytes = static_cast<double>(cost.pieces) * level.chunk.cast<double>().prod() * each;
    return cost;
}

bool is_finer(const Geometry& a, const Geometry& b) {
    constexpr double clearly = 0.9;
    return a.spacing.prod() < std::pow(clearly, 3) * b.spacing.prod();
}

/// Both corners in index space, the lower one first.
std::pair<Vec3, Vec3> corners_in(const Geometry& level, const SeenBox& seen) {
    const Vec3 a = index_from_physical(level, seen.from), b = index_from_physical(level, seen.to);
    return {a.cwiseMin(b), a.cwiseMax(b)};
}

}  // namespace

SampleBox samples_in(const Geometry& level, const SeenBox& seen, const Index3& margin) {
    const auto [low, high] = corners_in(level, seen);
    const Vec3 last = (level.size - Index3::Ones()).cast<double>();
    const auto inside = [&](const Vec3& at) {
        return Index3(at.cwiseMax(Vec3::Zero()).cwiseMin(last).cast<int>());
    };
    const Vec3 more = margin.cast<double>();
    return {inside(low.array().floor() - more.array()), inside(high.array().ceil() + more.array())};
}

bool fits(const SeenStore& store, int level, const SampleBox& box, const DetailLimits& limits) {
    const Cost cost = cost_of(level_of(store, level), store.info->type, box);
    return cost.samples <= limits.most_samples && cost.pieces <= limits.most_pieces &&
           cost.bytes <= static_cast<double>(limits.most_bytes);
}

std::vector<int> finer_levels(const SeenStore& store, double pixel_mm) {
    std::vector<int> levels;
    for (int l = static_cast<int>(store.info->levels.size()) - 1; l >= store.finest; --l) {
        const Geometry& level = level_of(store, l).geometry;
        if (!is_finer(level, store.overview)) continue;
        levels.insert(levels.begin(), l);
        if (level.spacing.minCoeff() <= coarse_enough * pixel_mm) break;
    }
    return levels;
}

std::optional<int> level_for(const SeenStore& store, const SeenBox& seen,
                             const DetailLimits& limits) {
    for (const int level : finer_levels(store, seen.pixel_mm)) {
        const SampleBox box = samples_in(level_of(store, level).geometry, seen, Index3::Zero());
        if (fits(store, level, box, limits)) return level;
    }
    return std::nullopt;
}

std::vector<stream::DetailBox> coarse_to_fine(const SeenStore& store, int level,
                                              const SampleBox& box) {
    std::vector<stream::DetailBox> boxes{{level, box}};
    const Geometry& fine = level_of(store, level).geometry;
    const SeenBox seen{physical_from_index(fine, box.low.cast<double>()),
                       physical_from_index(fine, box.high.cast<double>()), 1};
    const auto levels = static_cast<int>(store.info->levels.size());
    for (int l = level + stride; l < levels; l += stride) {
        const Geometry& coarse = level_of(store, l).geometry;
        if (!is_finer(coarse, store.overview)) break;
        boxes.insert(boxes.begin(), {l, samples_in(coarse, seen, Index3::Ones())});
    }
    return boxes;
}

SampleBox slice_box(const SeenStore& store, int level, const SeenBox& seen, int axis) {
    const stream::Level& l = level_of(store, level);
    const auto [low, high] = corners_in(l.geometry, seen);
    Index3 margin = (wider * (high - low)).array().ceil().cast<int>() + 3;
    const int layers = std::clamp(l.chunk[axis], fewest_layers, most_layers);
    margin[axis] = layers / 2 - 1;
    return samples_in(l.geometry, seen, margin);
}

bool has_slice(const SeenStore& store, const stream::DetailBox& box, const SeenBox& seen,
               int axis) {
    Index3 margin = Index3::Constant(2);
    margin[axis] = fewest_layers / 2 - 1;
    const SampleBox needed = samples_in(level_of(store, box.level).geometry, seen, margin);
    return united(box.box, needed) == box.box;
}

}  // namespace palpate::viewer
