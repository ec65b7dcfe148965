// Samples with the distance that each has been moved, and the bricks of them that have terraces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::filters {

/// Samples of a box, and how far each was moved, slice by slice; x runs fastest. The volume's own
/// ones are as they are where they are floats, and how far they lie above the least one where they
/// are whole numbers.
struct MovedSamples {
    Index3 size;
    const float* floats = nullptr;  ///< [data units], or null, and then
    const std::uint16_t* whole = nullptr;
    std::ptrdiff_t own_slice = 0;    ///< from one slice to the next
    std::int16_t* moved = nullptr;   ///< [1/65536 level]; null: not moved
    std::ptrdiff_t moved_slice = 0;  ///< from one slice to the next
};

/// Which bricks of 16 x 16 x 16 samples are dequantized.
class TerracedBricks {
  public:
    static constexpr int edge = 16;

    /// None of those of a box whose first sample is `low` in the whole volume.
    TerracedBricks(const Index3& size, const Index3& low)
        : low_(low.unaryExpr([](int i) { return i % edge; })),
          count_((low_ + size).unaryExpr([](int i) { return (i + edge - 1) / edge; })),
          is_(std::size_t(count_.prod())) {}

    const Index3& count() const { return count_; }
    /// Along an axis, the brick of a sample of the box, and the first sample of a brick (below 0
    /// if the brick begins before the box).
    int brick_of(int axis, int sample) const { return (sample + low_[axis]) / edge; }
    int first_of(int axis, int brick) const { return brick * edge - low_[axis]; }
    /// Flags of the bricks along x.
    std::uint8_t* row(int y, int z) { return is_.data() + place(y, z); }
    const std::uint8_t* row(int y, int z) const { return is_.data() + place(y, z); }

    /// Adds those of `others` that touch one of these.
    void grow_into(const TerracedBricks& others);

  private:
    std::size_t place(int y, int z) const {
        return (std::size_t(z) * std::size_t(count_[1]) + std::size_t(y)) * std::size_t(count_[0]);
    }

    Index3 low_, count_;
    std::vector<std::uint8_t> is_;
};

}  // namespace palpate::filters
