// Stage 2, resident: the part of a grid's samples that is in memory, where all of them do not fit.
// Bricks of samples come and go in versions that share what stayed, like all samples
// (samples.hpp). See docs/streaming.md.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate {

/// Samples of a cube of the grid.
struct ResidentBrick {
    /// ResidentBricks::per_brick samples of the volume's type, x fastest; null: not in memory.
    std::shared_ptr<const std::byte[]> samples;
    /// The level of detail that they come from: 0 is the grid's own, others are interpolated from
    /// coarser ones.
    std::uint8_t level = 0;
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
    struct Change {
        Index3 brick;
        ResidentBrick to;
    };

    /// None of a grid of this size.
    explicit ResidentBricks(const Index3& size);
    /// The same but for these changes. A brick outside the grid throws std::out_of_range.
    ResidentBricks with(std::span<const Change> changes) const;

    /// Bricks along each axis.
    const Index3& count() const { return count_; }
    /// How many are in memory.
    std::size_t size() const { return size_; }
    static Index3 brick_of(const Index3& sample) {
        return {sample[0] >> shift, sample[1] >> shift, sample[2] >> shift};
    }
    /// The samples that a brick holds, margins included, clipped to the grid.
    SampleBox box_of(const Index3& brick) const;
    /// The brick that a sample inside the grid belongs to; null: not in memory.
    const ResidentBrick* of_sample(const Index3& sample) const { return at(brick_of(sample)); }
    const ResidentBrick* at(const Index3& brick) const {
        const Page* page = pages_[page_of(brick)].get();
        if (!page) return nullptr;
        const ResidentBrick& found = (*page)[place_in_page(brick)];
        return found.samples ? &found : nullptr;
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
    static constexpr int page_shift = 4;
    static constexpr int page_edge = 1 << page_shift;
    using Page = std::array<ResidentBrick, std::size_t{page_edge} * page_edge * page_edge>;

    std::size_t page_of(const Index3& brick) const {
        return (std::size_t(brick[2] >> page_shift) * std::size_t(pages_along_[1]) +
                std::size_t(brick[1] >> page_shift)) *
                   std::size_t(pages_along_[0]) +
               std::size_t(brick[0] >> page_shift);
    }
    static std::size_t place_in_page(const Index3& brick) {
        constexpr int mask = page_edge - 1;
        return std::size_t((((brick[2] & mask) << page_shift | (brick[1] & mask)) << page_shift) |
                           (brick[0] & mask));
    }

    Index3 grid_;         // samples along each axis
    Index3 count_;        // bricks
    Index3 pages_along_;  // pages
    std::size_t size_ = 0;
    std::vector<std::shared_ptr<const Page>> pages_;  // null: none of its bricks is in memory
};

}  // namespace palpate
