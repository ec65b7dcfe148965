// The boxes of samples that a round sweeps: where bricks have terraces, and little else.
#pragma once

#include <vector>

#include "filters/terraced_bricks.hpp"

namespace palpate::filters {

/// Samples begin_x to end_x - 1 of rows begin_y to end_y - 1 of slices begin_z to end_z - 1.
struct Strip {
    int begin_x, end_x, begin_y, end_y, begin_z, end_z;
};

/// Strips that together have all samples of these bricks from slice begin_z to slice end_z - 1. One
/// is cut where its parts are less work to sweep, because bricks between them have no terraces.
/// What a sweep keeps of a strip fits into a second-level cache.
std::vector<Strip> strips_of(const TerracedBricks& bricks, const MovedSamples& samples, int begin_z,
                             int end_z);

}  // namespace palpate::filters
