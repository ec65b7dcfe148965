// One round of dequantization, in place: every sample moves to where its neighbours put it, as far
// as its level allows.
#pragma once

#include <functional>
#include <limits>
#include <span>

#include "palpate/volume.hpp"

namespace palpate::filters {

/// Calls work(begin, end) for ranges that cover the rows 0 to count - 1, several at the same time.
/// Returns when all are done.
using ForRows = std::function<void(int count, const std::function<void(int, int)>& work)>;

struct RoundSettings {
    int step = 1;  ///< distance of the neighbours that count [samples]
    /// How far a sample may be from the volume's own [data units].
    float half = 0.5F;
    /// A sample keeps its value where one smoothing more would change it by more than this [data
    /// units]: there the data are not straight over the distance `step`.
    float straight = 0;
    /// Bounds of the samples [data units].
    float least = -std::numeric_limits<float>::infinity();
    float greatest = std::numeric_limits<float>::infinity();
};

/// Takes `state` (x fastest, as many as the volume's samples) through one round; the formula is in
/// palpate/filters/dequantize.hpp. `at_slice` is called after every slice, from the calling thread.
/// The samples are the same, bit for bit, whatever ranges `rows` chooses. Allocates twelve slices.
void run_round(const Volume& volume, std::span<float> state, const RoundSettings& settings,
               const ForRows& rows, const std::function<void()>& at_slice);

}  // namespace palpate::filters
