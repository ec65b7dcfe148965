// Which bricks the hands need, the most urgent first. Private to stream/.
#pragma once

#include "palpate/stream/loader.hpp"

namespace palpate::stream {

/// Bricks round the way from each proxy to its hand and to where the hand will be, at most `most`.
std::vector<Index3> wanted_bricks(const Geometry& geometry, const Index3& count,
                                  std::span<const Interest> hands, std::size_t most);

/// Bricks of all samples that a proxy may look at within a radius [mm] of a point [mm, physical]
/// (reach.hpp).
std::vector<Index3> bricks_round(const Geometry& geometry, const Vec3& centre, double radius);

}  // namespace palpate::stream
