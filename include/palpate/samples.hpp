// Stage 2, samples: one version of the numbers on a grid. It is a volume with its edited bricks,
// the frames of a sequence, or the part of a large grid that is in memory, perhaps with edited
// bricks. A version never changes. A change makes a new version, published by pointer, and readers
// pick it up between two reads (copy on write). See docs/changing_data.md.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate {

/// One frame of a sequence.
struct Frame {
    double time;  ///< [s]
    Volume volume;
    int number = -1;  ///< of the frame in its file or series, from 0; -1: in neither
};

/// Samples of a cube of the grid.
struct Brick {
    std::shared_ptr<const std::byte[]> samples;  ///< of the volume's type, x fastest, or null
    /// The level of detail that they come from: 0 is the grid's own, others are interpolated from
    /// coarser ones.
    std::uint8_t level = 0;

    explicit operator bool() const { return samples != nullptr; }
    bool operator==(const Brick&) const = default;
};

/// A table over a box of bricks most of which are empty: a tree whose nodes have 8 x 8 x 8 places.
/// A value. Versions share the nodes that did not change (copy on write).
class SparseBricks {
  public:
    /// A brick to put in; an empty one removes the brick there.
    struct Change {
        Index3 at;
        Brick to;
    };

    /// Bricks along each axis.
    const Index3& count() const { return count_; }
    /// How many are not empty.
    std::size_t size() const { return size_; }
    /// Null if it is empty. The brick must be inside the grid.
    const Brick* at(const Index3& brick) const {
        const void* node = root_.get();
        for (int level = depth_; level > 0 && node; --level) {
            node = static_cast<const Fork*>(node)->at[place_in(brick, level)].get();
        }
        if (!node) return nullptr;
        const Brick& found = static_cast<const Leaf*>(node)->at[place_in(brick, 0)];
        return found ? &found : nullptr;
    }
    /// Calls visit(at, mine, theirs) for each brick that `other`, a table of the same size, does
    /// not share.
    void for_each_apart(const SparseBricks& other,
                        const std::function<void(const Index3& at, const Brick& mine,
                                                 const Brick& theirs)>& visit) const;
    /// Calls visit(at, brick) for each brick that is not empty.
    void for_each(const std::function<void(const Index3& at, const Brick& brick)>& visit) const;
    /// Bytes of the part of this table that `other` does not share, without the bricks.
    std::size_t table_bytes_apart(const SparseBricks& other) const;

  protected:
    explicit SparseBricks(const Index3& count);
    /// Throws std::out_of_range for a brick outside the grid.
    void change(std::span<const Change> changes);

  private:
    using Node =
        std::shared_ptr<const void>;  // a fork, or at level 0 a leaf, or null if all is empty
    struct Fork {
        std::array<Node, 512> at;
    };
    struct Leaf {
        std::array<Brick, 512> at;
    };

    static std::size_t place_in(const Index3& brick, int level) {
        const int shift = 3 * level;
        return std::size_t((brick[2] >> shift & 7) << 6 | (brick[1] >> shift & 7) << 3 |
                           (brick[0] >> shift & 7));
    }
    Node changed(const Node& node, int level, std::span<const Change> changes);
    template <class Visit>
    static void for_each_node_apart(const void* mine, const void* theirs, int level,
                                    const Index3& first, Visit&& visit);

    Index3 count_;
    int depth_ = 0;  // levels of forks
    std::size_t size_ = 0;
    Node root_;
};

/// Bricks of 2^shift samples along each axis, which store `more` samples behind them, too. A
/// brick's samples outside the grid may have any value.
template <int shift, int more>
class BrickTable : public SparseBricks {
  public:
    static constexpr int edge = 1 << shift;
    static constexpr std::ptrdiff_t row = edge + more;  ///< samples between neighbours in y
    static constexpr std::ptrdiff_t slice = row * row;  ///< and in z
    static constexpr std::size_t per_brick = std::size_t{slice} * row;

    /// None of a grid of this size.
    explicit BrickTable(const Index3& size)
        : SparseBricks((size + Index3::Constant(edge - 1)) / edge) {}
    /// A table with these changes. A brick outside the grid throws std::out_of_range.
    BrickTable with(std::span<const Change> changes) const {
        BrickTable after = *this;
        after.change(changes);
        return after;
    }
    static Index3 brick_of(const Index3& sample) {
        return {sample[0] >> shift, sample[1] >> shift, sample[2] >> shift};
    }
    /// The box of samples that a brick stores, clipped to a grid of this size.
    static SampleBox box_of(const Index3& brick, const Index3& size) {
        const Index3 low = brick * edge;
        return {low, (low + Index3::Constant(edge + more)).cwiseMin(size) - Index3::Ones()};
    }
    /// The brick that a sample inside the grid belongs to, or null.
    const Brick* of_sample(const Index3& sample) const { return at(brick_of(sample)); }
    /// Place of a sample among those of its brick.
    static std::ptrdiff_t place_of(const Index3& sample) {
        constexpr int mask = edge - 1;
        return (sample[0] & mask) + (sample[1] & mask) * row + (sample[2] & mask) * slice;
    }
};

/// Edited samples. Two neighbours both hold the samples on their common face, with equal values, so
/// that the whole cell of a sample lies in its brick. The grid's own samples count in place of
/// empty bricks.
using Bricks = BrickTable<4, 1>;
/// The part of a large grid that is in memory (docs/streaming.md).
using ResidentBricks = BrickTable<6, 0>;

/// A moment of a sequence, as a place between two frames.
struct Moment {
    std::size_t from = 0, to = 0;  ///< indices of the frames before and after
    double weight = 0;             ///< of `to`, 0 to below 1; `from` has the rest
};

/// One version. Immutable, held by shared pointers. Versions share unchanged parts.
class Samples {
  public:
    /// A volume without edits.
    explicit Samples(Volume volume);
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
    /// The same with these edits. `minimum` and `maximum` [data units] bound the samples of the
    /// bricks. Throws std::invalid_argument if the bricks do not fit the grid.
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
/// files and for code that needs one array. It shares an existing volume if that has the same
/// samples. For a large grid, the overview with the edits (ShownEdits). `progress` is called while
/// samples are copied.
Volume flattened(const Samples& samples, const Moment& moment = {},
                 const OnProgress& progress = {});
/// Shows the edits of a large grid on a volume with other samples of the same part of space (an
/// overview, or a box of some level). Each of its samples takes the value of the nearest sample of
/// the grid if that lies in an edited brick. One thread at a time.
class ShownEdits {
  public:
    explicit ShownEdits(Volume shown);
    /// The volume with the edits of these samples, which have the same type and are a version of
    /// the same grid in every call. Bricks that did not change since the last call are shared. The
    /// same pointer if nothing changed.
    std::shared_ptr<const Samples> of(const Samples& edited);

  private:
    Brick brick_of(const Index3& brick, const Samples& edited) const;

    std::shared_ptr<const Samples> plain_, with_edits_;
    Bricks bricks_;  // of with_edits_
    std::optional<Bricks> from_;
};
/// Bytes of the bricks of `samples` that `other` does not share.
std::size_t bytes_apart(const Samples& samples, const Samples& other);

}  // namespace palpate
