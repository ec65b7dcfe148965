// Stage 3, samples: one version of the numbers on a grid, which is a volume with its edited
// bricks, the frames of a sequence, or the part of a large grid that is in memory, perhaps with
// edited bricks. A version never changes. A change makes a new version, published by pointer, and
// readers pick it up between two reads (copy on write). See docs/changing_data.md.
#pragma once

#include <array>
#include <functional>
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
/// common face, with equal values. A brick that was not edited is null: there the grid's own
/// samples count. Samples of a brick outside the grid are 0. A value; copies share their bricks.
class Bricks {
  public:
    static constexpr int cells = 16;
    static constexpr int samples = cells + 1;
    static constexpr int per_brick = samples * samples * samples;
    /// Samples of the volume's type, x fastest.
    using Brick = std::shared_ptr<const std::byte[]>;
    struct Change {
        Index3 brick;
        Brick to;
    };

    /// None of a grid of this size is edited.
    explicit Bricks(const Index3& size);
    /// The same but for these changes. A brick outside the grid throws std::out_of_range.
    Bricks with(std::span<const Change> changes) const;

    /// Bricks along each axis.
    const Index3& count() const { return count_; }
    /// How many are edited.
    std::size_t size() const { return size_; }
    /// Null if it was not edited. The brick must be inside the grid.
    Brick at(const Index3& brick) const {
        const Brick* found = find(brick);
        return found ? *found : nullptr;
    }
    /// The brick of a cell inside the grid; null if it was not edited.
    const std::byte* of_cell(const Index3& cell) const {
        const Brick* found = find({cell[0] >> 4, cell[1] >> 4, cell[2] >> 4});
        return found ? found->get() : nullptr;
    }
    /// Calls visit(brick, mine, theirs) for each brick that `other`, of the same grid, does not
    /// share: its place, and what is here and there.
    void for_each_apart(const Bricks& other,
                        const std::function<void(const Index3& brick, const Brick& mine,
                                                 const Brick& theirs)>& visit) const;
    /// Calls visit(brick, samples) for each edited brick.
    void for_each(
        const std::function<void(const Index3& brick, const Brick& samples)>& visit) const;
    /// Bytes that this takes, besides the bricks, for what `other` does not share.
    std::size_t table_bytes_apart(const Bricks& other) const;

  private:
    /// 4 x 4 x 4 bricks.
    using Block = std::array<Brick, 64>;
    using Blocks = Pages<std::shared_ptr<const Block>, 3>;

    static std::size_t place_in_block(const Index3& brick) {
        return std::size_t((brick[2] & 3) << 4 | (brick[1] & 3) << 2 | (brick[0] & 3));
    }
    const Brick* find(const Index3& brick) const {
        const auto* block = blocks_.at({brick[0] >> 2, brick[1] >> 2, brick[2] >> 2});
        return block && *block ? &(**block)[place_in_block(brick)] : nullptr;
    }

    Index3 count_;
    std::size_t size_ = 0;
    Blocks blocks_;
};

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
    /// The same with these edits; `minimum` and `maximum` [data units] bound the bricks' samples.
    /// Throws std::invalid_argument if the bricks do not fit the grid.
    Samples with(Bricks bricks, double minimum, double maximum) const;
    /// The same large grid with another part in memory. Throws std::invalid_argument for
    /// bricks of another grid.
    Samples with(ResidentBricks resident) const;

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
    const Bricks* bricks() const { return bricks_ ? &*bricks_ : nullptr; }
    /// Bounds of all samples [data units], edits and frames included.
    double minimum() const { return minimum_; }
    double maximum() const { return maximum_; }

    /// The moment at a time [s]. Without a period, times before the first frame give the first
    /// frame and times after the last one the last. NaN gives the first. Does not allocate.
    Moment moment_at(double time) const noexcept;
    /// The time [s] clamped to that of the frames; unchanged where the sequence repeats.
    double within(double time) const noexcept;
    /// One sample at a moment, in the data's units; the index must be inside the grid, and the
    /// sample edited or in memory.
    double sample(const Index3& index, const Moment& moment = {}) const;

  private:
    std::vector<Frame> frames_;
    Geometry geometry_;
    double period_ = 0;
    std::optional<Bricks> bricks_;
    std::optional<ResidentBricks> resident_;
    double minimum_ = 0;
    double maximum_ = 0;
};

/// The samples at a moment as one volume of the same type (rounded to it between two frames), for
/// files and for code that needs them in one piece. No copy is made where an existing volume is the
/// same. For a large grid, the overview with the edits (ShownEdits).
Volume flattened(const Samples& samples, const Moment& moment = {});
/// Edits of a large grid on a volume of the same part of space that has other samples (an overview,
/// or a box of some level): each of those whose nearest sample lies in an edited brick takes its
/// value. One thread at a time.
class ShownEdits {
  public:
    explicit ShownEdits(Volume shown);
    /// The volume with the edits of these samples, of the same type, all versions of one grid. What
    /// did not change since the last call is shared; the same pointer where nothing did.
    std::shared_ptr<const Samples> of(const Samples& edited);

  private:
    Bricks::Brick brick_of(const Index3& brick, const Samples& edited) const;

    std::shared_ptr<const Samples> plain_, with_edits_;
    Bricks bricks_;  // of with_edits_
    std::optional<Bricks> from_;
};
/// Bytes of the bricks of `samples` that `other` does not share.
std::size_t bytes_apart(const Samples& samples, const Samples& other);

}  // namespace palpate
