// Rounds of dequantization on one grid, in place. In a round, every sample moves to where its
// neighbours put it, as far as its level allows. Finer grids are interpolated from coarser ones.
#pragma once

#include <functional>

#include "filters/terraced_bricks.hpp"

namespace palpate::filters {

/// Takes all samples of these bricks through `count` rounds; the formula is in
/// palpate/filters/dequantize.hpp. With `coarser`, a copy of every_second(samples), only these are
/// moved, and only there. `at_slab` is called from the calling thread with the number of slices
/// that were done since the last call. The result is the same, bit for bit, on any number of
/// threads. Allocates an eighth of `samples.moved`, and 1 MB per thread.
void repeat_round(const MovedSamples& samples, const Levels& levels, const TerracedBricks& bricks,
                  int count, const Parallel& parallel,
                  const std::function<void(int slices)>& at_slab,
                  const MovedSamples* coarser = nullptr);

/// Moves the samples of these bricks that are not every_second() to where a cubic interpolation of
/// these puts them, as far as their levels allow, and less where the data bend on the coarser grid.
/// `at_slab` as in repeat_round().
void refine(const MovedSamples& samples, const Levels& levels, const TerracedBricks& bricks,
            const Parallel& parallel, const std::function<void(int slices)>& at_slab);

}  // namespace palpate::filters
