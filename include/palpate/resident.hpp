// Stage 2, resident: the part of a grid's samples that is in memory, where all of them do not fit.
// Bricks of samples come and go in versions that share what stayed, like all samples
// (samples.hpp). See docs/streaming.md.
#pragma once

#include <memory>
#include <span>

#include "palpate/pages.hpp"

namespace palpate {

/// Samples of a cube of the grid.
struct ResidentBrick {
    /// ResidentBricks::per_brick samples of the volume's type, x fastest; null: not in memory.
    std::shared_ptr<const std::byte[]> samples;
    /// The level of detail that they come from: 0 is the grid's own, others are interpolated from
    /// coarser ones.
    std::uint8_t level = 0;

    explicit operator bool() const { return samples != nullptr; }
};

/// A value; copies share their bricks. A brick has edge^3 samples and those around them (`margin`),
/// so that a cell lies in the brick of its lowest corner, and a sample's neighbours lie in the
/// brick of that sample. Samples of a brick outside the grid have any value.
class ResidentBricks {
  public:
    static constexpr int shift = 6;
    static constexpr int edge = 1 << shift;
    static constexpr int margin = 1;
    static constexpr std::ptrdiff_t row = edge + 2 * margin;  ///< samples between neighbours in y
    static constexpr std::ptrdiff_t slice = row * row;        ///< and in z
    static constexpr std::size_t per_brick = std::size_t{slice} * row;

    /// A brick that comes, or with null samples goes.
    using Change = Pages<ResidentBrick, 4>::Change;

    /// None of a grid of this size.
    explicit ResidentBricks(const Index3& size);
    /// The same but for these changes. A brick outside the grid throws std::out_of_range.
    ResidentBricks with(std::span<const Change> changes) const;

    /// Bricks along each axis.
    const Index3& count() const { return bricks_.count(); }
    /// How many are in memory.
    std::size_t size() const { return bricks_.size(); }
    static Index3 brick_of(const Index3& sample) {
        return {sample[0] >> shift, sample[1] >> shift, sample[2] >> shift};
    }
    /// The samples that a brick holds, margins included, clipped to the grid.
    SampleBox box_of(const Index3& brick) const;
    /// The brick that a sample inside the grid belongs to; null: not in memory.
    const ResidentBrick* of_sample(const Index3& sample) const { return at(brick_of(sample)); }
    const ResidentBrick* at(const Index3& brick) const {
        const ResidentBrick* found = bricks_.at(brick);
        return found && found->samples ? found : nullptr;
    }
    /// Place of a sample among those of its brick.
    static std::ptrdiff_t place_of(const Index3& sample) {
        constexpr int mask = edge - 1;
        return ((sample[0] & mask) + margin) + ((sample[1] & mask) + margin) * row +
               ((sample[2] & mask) + margin) * slice;
    }
    /// True if all samples of a box, clipped to the grid, are in memory.
    bool has(const SampleBox& box) const;

  private:
    Index3 grid_;  // samples along each axis
    Pages<ResidentBrick, 4> bricks_;
};

}  // namespace palpate
