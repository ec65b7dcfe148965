// The step from a coarser grid to the next finer one.
#pragma once

#include "filters/round.hpp"

namespace palpate::filters {

/// Moves the samples of terraced bricks that are not every_second() to where a cubic interpolation
/// of these puts them, as far as their levels allow, and less where the data bend on the coarser
/// grid. `coarse` are that grid's settings. `at_slab` as in run_round().
void refine(const MovedSamples& samples, const LevelScale& scale, const RoundSettings& coarse,
            const TerracedBricks& bricks, const Parallel& parallel,
            const std::function<void(int slices)>& at_slab);

}  // namespace palpate::filters
