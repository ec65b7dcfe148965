// Which bricks the hands need, the most urgent first. Private to stream/.
#pragma once

#include "palpate/stream/loader.hpp"

namespace palpate::stream {

/// Bricks round the way from each proxy to its hand and to where the hand will be, at most `most`.
/// A brick takes `seconds` to come.
std::vector<Index3> wanted_bricks(const Geometry& geometry, const Index3& count,
                                  std::span<const Interest> hands, std::size_t most,
                                  double seconds);

/// Bricks of all samples that a proxy may look at within a radius [mm] of a point [mm, physical]
/// (reach.hpp).
std::vector<Index3> bricks_round(const Geometry& geometry, const Vec3& centre, double radius);

/// Levels of detail, as steps coarser than the one that is felt.
struct LevelChoice {
    int first = 0;   ///< read everywhere near before anything finer
    int finest = 0;  ///< then this one
    bool operator==(const LevelChoice&) const = default;
};

/// Where a brick takes `seconds` to come, a hand that passes through more than one meanwhile is
/// given the level whose bricks it passes through one by one; before that comes one two steps
/// coarser. `speed` [bricks/s]; there are levels up to `coarsest`.
LevelChoice levels_for(double speed, double seconds, int coarsest);

}  // namespace palpate::stream
