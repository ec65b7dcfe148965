// The sites for the choice of steps: samples spread over a volume, with slope and bend of the data.
#pragma once

#include <functional>

#include "palpate/volume.hpp"

namespace palpate::filters {

/// Calls work for up to about `most` samples of a grid, at even distances, none on the border; only
/// for those in `core`.
void for_sites(const Index3& size, double most, const SampleBox& core,
               const std::function<void(const Index3&)>& work);

inline SampleBox whole_of(const Volume& volume) {
    return {Index3::Zero(), volume.geometry().size - Index3::Ones()};
}

/// Slope over four samples, so that a terrace or two is no plateau [data units a sample].
double slope_at(const Volume& volume, const Index3& at);

/// True for samples of two values only, `level` apart.
inline bool is_mask(double minimum, double maximum, double level) {
    return maximum - minimum <= 1.5 * level;
}

struct Smooth {
    double mean;   ///< b, the binomial mean of the 27 neighbours `step` apart [data units]
    double twice;  ///< Bb
};
/// As dequantized() has them. Samples beyond the border count as those on it.
Smooth smooth_at(const Volume& volume, const Index3& at, int step);

}  // namespace palpate::filters
