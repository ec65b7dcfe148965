// Stage 2, samples: what the numbers on a grid are at one moment, where they may change: a volume
// with the bricks of it that were edited, or frames of a sequence. A value of this type never
// changes; change is another value, and whoever looks is handed it between two looks (copy on
// write, published by pointer). See docs/living_data.md.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate {

/// One frame of a sequence.
struct Frame {
    double time;  ///< [s]
    Volume volume;
    int number = -1;  ///< which frame of its file or series, from 0; -1: of none
};

/// A box of samples, both corners in it; empty if `high` is below `low` on some axis.
struct SampleBox {
    Index3 low = Index3::Zero();
    Index3 high = Index3::Constant(-1);

    bool empty() const { return (high.array() < low.array()).any(); }
    bool operator==(const SampleBox&) const = default;
};
/// The smallest box round both; the other one if one is empty.
SampleBox united(const SampleBox& a, const SampleBox& b);
/// All samples of a grid.
SampleBox whole_box(const Geometry& geometry);

/// Edited samples: cells in bricks of 16 x 16 x 16, each with the 17 x 17 x 17 samples at their
/// corners, so that a cell lies in one brick. Neighbours hold the samples between them twice, and
/// alike. A brick that nobody edited is null: there the volume's own samples count. Samples of a
/// brick beyond the grid are 0.
struct Bricks {
    static constexpr int cells = 16;
    static constexpr int samples = cells + 1;
    static constexpr int per_brick = samples * samples * samples;

    Index3 count = Index3::Zero();  ///< bricks along each axis, x fastest
    std::vector<std::shared_ptr<const std::byte[]>>
        at;  ///< samples of the volume's type, x fastest

    /// The brick of a cell inside the grid; null if it was not edited.
    const std::byte* of_cell(const Index3& cell) const {
        const Index3 brick(cell[0] >> 4, cell[1] >> 4, cell[2] >> 4);
        return at[place(brick)].get();
    }
    std::size_t place(const Index3& brick) const {
        return (static_cast<std::size_t>(brick[2]) * count[1] + brick[1]) * count[0] + brick[0];
    }
};
/// As many as the grid needs, none of them edited.
Bricks no_bricks(const Geometry& geometry);

/// Where a moment lies in a sequence: between two frames, that many parts of the way.
struct Moment {
    std::size_t from = 0, to = 0;  ///< frames
    double weight = 0;             ///< 0: `from`; below 1
};

/// Immutable. Held by shared pointers; versions share what did not change.
class Samples {
  public:
    /// A volume that nobody edited.
    explicit Samples(Volume volume);
    /// A volume with edits; `minimum` and `maximum` [data units] bound what the bricks hold. Throws
    /// std::invalid_argument if the bricks do not fit the grid.
    Samples(Volume volume, Bricks bricks, double minimum, double maximum);
    /// A sequence, or the part of one that is in memory. With a `period` [s] it goes round: from
    /// the last frame it goes on to the first, which comes again a period after its own time.
    /// Throws std::invalid_argument unless there is a frame, all have the same geometry and sample
    /// type, times are finite and rising, and the period is 0 or ends after the last frame.
    explicit Samples(std::vector<Frame> frames, double period = 0);

    /// The volume as it was before edits; of a sequence the first frame.
    const Volume& volume() const { return frames_.front().volume; }
    const Geometry& geometry() const { return volume().geometry(); }
    SampleType type() const { return volume().type(); }
    /// At least one.
    std::span<const Frame> frames() const { return frames_; }
    double period() const { return period_; }
    /// Null if nothing was edited.
    const Bricks* bricks() const { return bricks_.at.empty() ? nullptr : &bricks_; }
    /// Bounds of all samples [data units], edits and frames included.
    double minimum() const { return minimum_; }
    double maximum() const { return maximum_; }

    /// Where a time [s] lies. Before the first frame it is the first, after the last the last,
    /// unless there is a period. NaN counts as the first. Does not allocate.
    Moment moment_at(double time) const noexcept;
    /// The time [s] kept within the frames there are; any time where they go round.
    double within(double time) const noexcept;
    /// One sample at a moment, in the data's units; the index must be inside the grid.
    double sample(const Index3& index, const Moment& moment = {}) const;

  private:
    std::vector<Frame> frames_;
    double period_ = 0;
    Bricks bricks_;
    double minimum_ = 0;
    double maximum_ = 0;
};

/// The samples at a moment as a volume of their own, in the same type (between two frames rounded
/// to it): for files and for whoever needs them in one piece. The volume itself, not a copy, where
/// that is the same.
Volume flattened(const Samples& samples, const Moment& moment = {});
/// Bytes of the bricks that `samples` holds and `other` does not share.
std::size_t bytes_apart(const Samples& samples, const Samples& other);

}  // namespace palpate
