// The boxes of samples that a round sweeps: they cover the bricks with terraces, and little else.
#pragma once

#include <vector>

#include "filters/terraced_bricks.hpp"

namespace palpate::filters {

/// Samples begin_x to end_x - 1 of rows begin_y to end_y - 1 of slices begin_z to end_z - 1.
struct Strip {
    int begin_x, end_x, begin_y, end_y, begin_z, end_z;
};

/// Strips that together have all samples of these bricks from slice begin_z to slice end_z - 1. A
/// strip is cut at bricks without terraces, if sweeping its parts is then less work. The rows that
/// a sweep keeps fit into a second-level cache.
std::vector<Strip> strips_of(const TerracedBricks& bricks, const MovedSamples& samples, int begin_z,
                             int end_z);

}  // namespace palpate::filters
