// Stage 3, samples: one version of the numbers on a grid, which is a volume with its edited
// bricks, the frames of a sequence, or the part of a large grid that is in memory. A version never
// changes. A change makes a new version, published by pointer, and readers pick it up between two
// reads (copy on write). See docs/changing_data.md.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "palpate/resident.hpp"

namespace palpate {

/// One frame of a sequence.
struct Frame {
    double time;  ///< [s]
    Volume volume;
    int number = -1;  ///< of the frame in its file or series, from 0; -1: in neither
};

/// Edited samples: bricks of 16 x 16 x 16 cells, each with the 17 x 17 x 17 samples at their
/// corners, so that every cell lies in one brick. Two neighbours both hold the samples on their
/// common face, with equal values. A brick that was not edited is null: there the volume's own
/// samples count. Samples of a brick outside the grid are 0.
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
/// As many bricks as the grid needs, none of them edited.
Bricks no_bricks(const Geometry& geometry);

/// A moment of a sequence, as a place between two frames.
struct Moment {
    std::size_t from = 0, to = 0;  ///< indices of the frames before and after
    double weight = 0;             ///< of `to`, 0 to below 1; `from` has the rest
};

/// One version. Immutable, held by shared pointers; versions share what did not change.
class Samples {
  public:
    /// A volume without edits.
    explicit Samples(Volume volume);
    /// A volume with edits; `minimum` and `maximum` [data units] bound the bricks' samples. Throws
    /// std::invalid_argument if the bricks do not fit the grid.
    Samples(Volume volume, Bricks bricks, double minimum, double maximum);
    /// A sequence, or the part of one that is in memory. With a `period` [s] it repeats: the last
    /// frame is followed by the first, a period after the first frame's own time.
    /// Throws std::invalid_argument unless there is a frame, all have the same geometry and sample
    /// type, times are finite and rising, and the period is 0 or ends after the last frame.
    explicit Samples(std::vector<Frame> frames, double period = 0);
    /// The part of a large grid that is in memory. `overview` shows the same part of space by fewer
    /// samples of the same type; `minimum` and `maximum` [data units] are those of the whole grid,
    /// as far as they are known. Throws std::invalid_argument for a geometry that is not valid,
    /// bricks of another grid, and bounds that are not finite or in the wrong order.
    Samples(Volume overview, const Geometry& geometry, ResidentBricks resident, double minimum,
            double maximum);

    /// The volume before all edits; of a sequence the first frame; of a large grid its overview,
    /// which has another geometry.
    const Volume& volume() const { return frames_.front().volume; }
    const Geometry& geometry() const { return geometry_; }
    SampleType type() const { return volume().type(); }
    /// Null if all samples are in memory.
    const ResidentBricks* resident() const { return resident_ ? &*resident_ : nullptr; }
    /// At least one.
    std::span<const Frame> frames() const { return frames_; }
    double period() const { return period_; }
    /// Null if nothing was edited.
    const Bricks* bricks() const { return bricks_.at.empty() ? nullptr : &bricks_; }
    /// Bounds of all samples [data units], edits and frames included.
    double minimum() const { return minimum_; }
    double maximum() const { return maximum_; }

    /// The moment at a time [s]. Without a period, times before the first frame give the first
    /// frame and times after the last one the last. NaN gives the first. Does not allocate.
    Moment moment_at(double time) const noexcept;
    /// The time [s] clamped to that of the frames; unchanged where the sequence repeats.
    double within(double time) const noexcept;
    /// One sample at a moment, in the data's units; the index must be inside the grid, and the
    /// sample in memory.
    double sample(const Index3& index, const Moment& moment = {}) const;

  private:
    std::vector<Frame> frames_;
    Geometry geometry_;
    double period_ = 0;
    Bricks bricks_;
    std::optional<ResidentBricks> resident_;
    double minimum_ = 0;
    double maximum_ = 0;
};

/// The samples at a moment as one volume of the same type (rounded to it between two frames), for
/// files and for code that needs them in one piece. No copy is made where an existing volume is the
/// same. Of a large grid: the overview.
Volume flattened(const Samples& samples, const Moment& moment = {});
/// Bytes of the bricks of `samples` that `other` does not share.
std::size_t bytes_apart(const Samples& samples, const Samples& other);

}  // namespace palpate
