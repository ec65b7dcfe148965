// Field: the eight samples of any cell in space, background outside the grid.
#include "palpate/field.hpp"

#include <algorithm>
#include <cmath>
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
}

template <class T>
CellSamples Field::border_cell_of(const Index3& cell) const {
    CellSamples samples;
    for (int corner = 0; corner < 8; ++corner) {
        const Index3 at = cell + Index3(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
        const bool inside = (at.array() >= 0).all() && (at.array() < size_.array()).all();
        samples[corner] = inside
                              ? static_cast<const T*>(data_)[at[0] + at[1] * row_ + at[2] * slice_]
                              : background_;
    }
    return samples;
}

template <class T>
CellSamples Field::cell_of(const Index3& cell) const {
    // One unsigned comparison an axis covers both ends of the grid.
    const bool interior = static_cast<unsigned>(cell[0]) < static_cast<unsigned>(size_[0] - 1) &&
                          static_cast<unsigned>(cell[1]) < static_cast<unsigned>(size_[1] - 1) &&
                          static_cast<unsigned>(cell[2]) < static_cast<unsigned>(size_[2] - 1);
    if (!interior) return border_cell_of<T>(cell);
    const T* p = static_cast<const T*>(data_) + (cell[0] + cell[1] * row_ + cell[2] * slice_);
    const T* q = p + slice_;
    return {double(p[0]), double(p[1]), double(p[row_]), double(p[row_ + 1]),
            double(q[0]), double(q[1]), double(q[row_]), double(q[row_ + 1])};
}

CellSamples Field::cell(const Index3& cell) const {
    switch (type_) {
        case SampleType::uint8:
            return cell_of<std::uint8_t>(cell);
        case SampleType::int16:
            return cell_of<std::int16_t>(cell);
        case SampleType::uint16:
            return cell_of<std::uint16_t>(cell);
        case SampleType::float32:
            break;
    }
    return cell_of<float>(cell);
}

}  // namespace palpate
