// Field: the eight samples of any cell in space, background outside the grid.
#include "palpate/field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate {

Field::Field(Volume volume, Solid solid, std::optional<double> background)
    : volume_(std::move(volume)),
      data_(volume_.data()),
      row_(volume_.geometry().size[0]),
      slice_(row_ * volume_.geometry().size[1]),
      background_(
          background.value_or(solid == Solid::above ? volume_.minimum() : volume_.maximum())),
      sign_(solid == Solid::above ? 1 : -1),
      size_(volume_.geometry().size),
      type_(volume_.type()),
      solid_(solid) {
    if (!std::isfinite(background_)) throw std::invalid_argument("the background is not finite");
    const double low = std::min(volume_.minimum(), background_);
    const double high = std::max(volume_.maximum(), background_);
    range_ = high > low ? high - low : 1.0;
    // Samples far from zero (a float volume of 1e6 +- 1) cost digits in every sum of eight.
    const double largest = std::max(std::abs(low), std::abs(high));
    tolerance_ = std::max(1e-12 * range_, 8 * std::numeric_limits<double>::epsilon() * largest);
    voxels_per_mm_ = volume_.geometry().spacing.cwiseInverse();
}

CellSamples Field::border_cell(const Index3& cell) const {
    CellSamples samples;
    for (int corner = 0; corner < 8; ++corner) {
        const Index3 at = cell + Index3(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
        const bool inside = (at.array() >= 0).all() && (at.array() < size_.array()).all();
        samples[corner] = inside ? volume_.sample(at) : background_;
    }
    return samples;
}

}  // namespace palpate
