// Samples with the distance that each has been moved, and the bricks of them that have terraces.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "filters/parallel.hpp"
#include "palpate/filters/dequantize_parts.hpp"

namespace palpate::filters {

/// Samples of a box, or some of them, and how far each was moved, slice by slice; x runs fastest.
/// The volume's own ones are as they are where they are floats, and how far they lie above the
/// least one where they are whole numbers.
struct MovedSamples {
    Index3 size;
    const float* floats = nullptr;  ///< [data units], or null, and then
    const std::uint16_t* whole = nullptr;
    std::int16_t* moved = nullptr;                  ///< [1/65536 level]; null: not moved
    std::ptrdiff_t own_slice = 0, moved_slice = 0;  ///< from one slice to the next
    std::ptrdiff_t row = 0;                         ///< from one row to the next
    int apart = 1;                                  ///< from one sample to the next, 1 or 2
    /// They are those of the whole volume whose indices are multiples of `step`; the first one is
    /// at step * low.
    int step = 1;
    Index3 low = Index3::Zero();
};

/// Along an axis, the first of every_second().
inline int first_coarser(const MovedSamples& samples, int axis) {
    return samples.low[axis] % 2;
}
/// Along an axis, is it one of every_second()?
inline bool is_coarser(const MovedSamples& samples, int axis, int at) {
    return (samples.low[axis] + at) % 2 == 0;
}
/// Those of the next coarser grid, every second one along each axis of compact samples.
MovedSamples every_second(const MovedSamples& samples);

/// True for samples of two values only, `level` apart.
inline bool is_mask(double minimum, double maximum, double level) {
    return maximum - minimum <= 1.5 * level;
}

/// How samples become numbers that rounds compute with (levels above the least one), and how far
/// they may move.
struct Levels {
    explicit Levels(const DequantizePlan& plan);

    float least;      ///< the volume's least sample [data units]
    float per_level;  ///< 1 / the distance between levels
    float top;        ///< the greatest sample [levels]
    float half;       ///< how far a sample may be from the volume's own [levels]
    /// On coarse grids, a sample moves less where one smoothing more would change it by more than
    /// this [levels], and not at all from twice of it on: there the data are not straight over the
    /// samples' distance.
    float straight;
};

/// Which bricks of 16 x 16 x 16 samples are dequantized.
class TerracedBricks {
  public:
    static constexpr int edge = 16;

    /// None of those of a box whose first sample is `low` in the whole volume.
    TerracedBricks(const Index3& size, const Index3& low)
        : first_(low / edge),
          count_((low + size).unaryExpr([](int i) { return (i + edge - 1) / edge; }) - first_),
          is_(std::size_t(count_.prod())) {}

    const Index3& count() const { return count_; }
    /// Along an axis, the brick of a sample, and the first of the samples that is not before a
    /// brick (below 0 if the brick begins before them).
    int brick_of(int axis, const MovedSamples& samples, int at) const {
        return (samples.low[axis] + at) * samples.step / edge - first_[axis];
    }
    int first_of(int axis, const MovedSamples& samples, int brick) const {
        const int begin = (first_[axis] + brick) * edge;
        return (begin + samples.step - 1) / samples.step - samples.low[axis];
    }
    /// Flags of the bricks along x.
    std::uint8_t* row(int y, int z) { return is_.data() + place(y, z); }
    const std::uint8_t* row(int y, int z) const { return is_.data() + place(y, z); }

    /// Calls work(from, to) for the samples from begin to end - 1 of a row that are in none of
    /// these.
    template <class Work>
    void for_others(const MovedSamples& samples, int y, int z, int begin, int end,
                    const Work& work) const {
        const std::uint8_t* is = row(brick_of(1, samples, y), brick_of(2, samples, z));
        const int last = brick_of(0, samples, end - 1);
        for (int brick = brick_of(0, samples, begin); brick <= last; ++brick) {
            if (is[brick]) continue;
            work(std::max(first_of(0, samples, brick), begin),
                 std::min(first_of(0, samples, brick + 1), end));
        }
    }
    /// Is one of these in rows begin_y to end_y - 1 of slices begin_z to end_z - 1?
    bool any(const MovedSamples& samples, int begin_y, int end_y, int begin_z, int end_z) const;

    /// Adds those of `others` that touch one of these.
    void grow_into(const TerracedBricks& others);

  private:
    std::size_t place(int y, int z) const {
        return (std::size_t(z) * std::size_t(count_[1]) + std::size_t(y)) * std::size_t(count_[0]);
    }

    Index3 first_, count_;
    std::vector<std::uint8_t> is_;
};

/// The bricks of a part of a volume that have terraces: on at least half of the surfaces in them,
/// rounding alone explains how far the samples (not yet moved) are from smooth ones. In a mask all
/// bricks that are not constant have terraces. Constant bricks belong to terraces that touch them.
/// Right for bricks that lie in the part with two samples around them, or end at the volume's
/// border.
TerracedBricks terraced_bricks(const MovedSamples& samples, const DequantizePlan& plan,
                               const Parallel& parallel);

}  // namespace palpate::filters
