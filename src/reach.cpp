// Reach: balls around the hand's goal, and the bricks that they touch.
#include "reach.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Samples around a point on which the field there depends, with those across the wall that it is
/// on [voxel].
constexpr double around = 3;
/// A pull is halved this often, a long one until it is no longer than this [voxel].
constexpr int fewest_halvings = 6;
constexpr double short_pull = 1;

}  // namespace

bool is_resident(const Field& field, const Vec3& centre, double radius) noexcept {
    const ResidentBricks* resident = field.samples().resident();
    if (!resident) return true;
    const Vec3 at = index_from_physical(field.geometry(), centre);
    const Index3& size = field.geometry().size;
    Index3 low, high;  // samples around the ball, and the bricks that they lie in
    for (int a = 0; a < 3; ++a) {
        const double reach = radius * field.voxels_per_mm()[a] + around, last = size[a] - 1;
        if (!(at[a] - reach <= last && at[a] + reach >= 0)) return true;  // background
        // Not below 0, so that truncation rounds down.
        low[a] = static_cast<int>(std::max(at[a] - reach, 0.0));
        high[a] = std::min(static_cast<int>(std::min(at[a] + reach, last)) + 1, size[a] - 1);
    }
    return !any_index({ResidentBricks::brick_of(low), ResidentBricks::brick_of(high)},
                      [&](const Index3& brick) { return !resident->at(brick); });
}

double part_within_reach(const Field& field, const Pull& pull) noexcept {
    const Vec3 way = pull.to - pull.from;
    const double length = pull.turn == 0 ? way.norm() : std::hypot(way.norm(), pull.turn);
    if (!field.samples().resident() || !std::isfinite(length)) return 1;  // the update refuses it
    const double voxels = length * field.voxels_per_mm().maxCoeff();
    double part = 1;
    for (int halvings = 0; halvings <= fewest_halvings || 2 * part * voxels > short_pull;
         ++halvings, part /= 2) {
        if (is_resident(field, pull.from + part * way, part * length + pull.arm)) return part;
    }
    return 0;
}

int level_at(const Field& field, const Vec3& physical) noexcept {
    const ResidentBricks* resident = field.samples().resident();
    if (!resident || !physical.allFinite()) return 0;
    const Vec3 last = (field.geometry().size - Index3::Ones()).cast<double>();
    const Vec3 at = index_from_physical(field.geometry(), physical);
    const Index3 low = at.cwiseMax(Vec3::Zero()).cwiseMin(last).cast<int>();
    const Index3 high = (low + Index3::Ones()).cwiseMin(last.cast<int>());
    int level = 0;
    for_each_index({ResidentBricks::brick_of(low), ResidentBricks::brick_of(high)},
                   [&](const Index3& at) {
                       const Brick* brick = resident->at(at);
                       if (brick) level = std::max<int>(level, brick->level);
                   });
    return level;
}

}  // namespace palpate
