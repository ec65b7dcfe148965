// One round of dequantization, in place: every sample moves to where its neighbours put it, as far
// as its level allows.
#pragma once

#include <functional>
#include <limits>

#include "filters/parallel.hpp"
#include "filters/terraced_bricks.hpp"

namespace palpate::filters {

/// How samples become numbers that rounds compute with: levels above the least one.
struct LevelScale {
    float least = 0;                                     ///< the volume's least sample [data units]
    float per_level = 1;                                 ///< 1 / the distance between levels
    float top = std::numeric_limits<float>::infinity();  ///< the greatest sample [levels]
};

struct RoundSettings {
    float half = 0.5F;  ///< how far a sample may be from the volume's own [levels]
    /// A sample moves less where one smoothing more would change it by more than this [levels], and
    /// not at all from twice of it on: there the data are not straight over the samples' distance.
    float straight = std::numeric_limits<float>::infinity();
};

/// Takes all samples of terraced bricks through one round; the formula is in
/// palpate/filters/dequantize.hpp. With `coarser`, a copy of every_second(samples), only these are
/// moved, and only there. `at_slab` is called from the calling thread with the number of slices
/// that were done since the last call. The result is the same, bit for bit, on any number of
/// threads. Allocates an eighth of `samples.moved`, and 1 MB per thread.
void run_round(const MovedSamples& samples, const LevelScale& scale, const RoundSettings& settings,
               const TerracedBricks& bricks, const Parallel& parallel,
               const std::function<void(int slices)>& at_slab,
               const MovedSamples* coarser = nullptr);

/// The bricks of a part of a volume that have terraces: on at least half of the surfaces in them,
/// rounding alone explains how far the samples (not yet moved) are from smooth ones. In a mask all
/// bricks that are not constant have terraces. Constant bricks belong to terraces that touch them.
/// Right for bricks that lie in the part with two samples around them, or end at the volume's
/// border.
TerracedBricks terraced_bricks(const MovedSamples& samples, const LevelScale& scale, bool mask,
                               const Parallel& parallel);

}  // namespace palpate::filters
