// Stage 2, field: a volume continued over all of space, and which side of a level is solid.
// The one narrow door to the samples: the eight of a cell. Nothing above knows how they are stored.
#pragma once

#include <array>
#include <optional>

#include "palpate/volume.hpp"

namespace palpate {

/// Which side of the isovalue is solid: bright bodies on dark, or airways and vessels dark on
/// bright.
enum class Solid : std::uint8_t { above, below };

/// The eight samples at the corners of a cell, in the data's units.
/// Corner c has x offset (c & 1), y offset (c >> 1 & 1), z offset (c >> 2 & 1).
using CellSamples = std::array<double, 8>;

/// What to feel in a volume. A small value: copies share the samples.
class Field {
  public:
    /// `background` is the density outside the grid; without it the data's minimum, or its maximum
    /// when `solid` is below, so that bodies cut off by the border are closed there.
    /// Throws std::invalid_argument for a background that is not finite.
    explicit Field(Volume volume, Solid solid = Solid::above,
                   std::optional<double> background = std::nullopt);

    const Volume& volume() const { return volume_; }
    const Geometry& geometry() const { return volume_.geometry(); }
    Solid solid() const { return solid_; }
    double background() const { return background_; }
    /// +1 for above, -1 for below: sign * (density - isovalue) > 0 is solid.
    double sign() const { return sign_; }
    /// max - min of samples and background [data units], never 0: what tolerances are relative to.
    double range() const { return range_; }

    /// The samples of the cell whose lowest corner is `cell` (index space); any cell in space.
    CellSamples cell(const Index3& cell) const;
    /// True where all eight samples of `cell` are background.
    bool is_background(const Index3& cell) const {
        return (cell.array() < -1).any() || (cell.array() >= geometry().size.array()).any();
    }

  private:
    template <class T>
    CellSamples cell_of(const Index3& cell) const;
    template <class T>
    CellSamples border_cell_of(const Index3& cell) const;

    Volume volume_;
    const void* data_ = nullptr;
    std::ptrdiff_t row_ = 0;    // samples between neighbours in y
    std::ptrdiff_t slice_ = 0;  // samples between neighbours in z
    double background_ = 0;
    double range_ = 1;
    double sign_ = 1;
    Index3 size_;
    SampleType type_ = SampleType::uint8;
    Solid solid_ = Solid::above;
};

}  // namespace palpate
