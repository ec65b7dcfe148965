// Which part of a store a picture deserves at which level of detail, as far as memory and requests
// allow, and how a finer part joins the overview. These are pure functions. A thread makes
// such parts from samples that were read and from edits. The reader is stream/detail.hpp.
#pragma once

#include <array>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "palpate/field.hpp"
#include "palpate/stream/detail.hpp"

namespace palpate::viewer {

struct SeenStore {
    const stream::StoreInfo* info = nullptr;
    int finest = 0;     ///< level that is felt: pictures show nothing finer
    Geometry overview;  ///< what is there at once
};

/// A box along the grid's axes, between two of its corners, and how finely it is seen.
struct SeenBox {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< [mm, physical]
    double pixel_mm = 1;                          ///< of a device pixel

    bool operator==(const SeenBox&) const = default;
};

struct DetailLimits {
    std::int64_t most_samples = 0;  ///< of a box
    std::uint64_t most_bytes = 0;   ///< of the pieces that it lies in, unpacked
    std::int64_t most_pieces = 0;   ///< pieces, or rows of a plain file
};

/// The samples of a level that lie in the box, and `margin` more on each side; inside its grid.
SampleBox samples_in(const Geometry& level, const SeenBox& seen, const Index3& margin);

/// True if a box of a level is within the limits.
bool fits(const SeenStore& store, int level, const SampleBox& box, const DetailLimits& limits);
/// Levels that are finer than the overview, the one first that has about a sample a pixel (or the
/// finest allowed), coarser ones after it.
std::vector<int> finer_levels(const SeenStore& store, double pixel_mm);

/// The coarsest level with about a sample a pixel, else the finest that is allowed and within the
/// limits. Nothing where that is not finer than the overview.
std::optional<int> level_for(const SeenStore& store, const SeenBox& seen,
                             const DetailLimits& limits);

/// The box at every second level from the overview's to this one, coarse to fine. `box` is of
/// `level`.
std::vector<stream::DetailBox> coarse_to_fine(const SeenStore& store, int level,
                                              const SampleBox& box);

/// The box of a slice across `axis`: wider than what is seen, so that a small move needs nothing
/// new, and thicker. Pieces that are thick anyway give more layers.
SampleBox slice_box(const SeenStore& store, int level, const SeenBox& seen, int axis);
/// True if such a box still has what is seen, and the layers that a slice needs.
bool has_slice(const SeenStore& store, const stream::DetailBox& box, const SeenBox& seen, int axis);

struct SeenPoints {
    std::vector<Vec3> points;    ///< [mm, physical] spread over the picture
    Vec3 middle = Vec3::Zero();  ///< of interest: under the middle of the view, or the proxy
    double half_height = 1;      ///< of the view [mm]
    double pixel_mm = 1;         ///< of a device pixel
};

/// A part of the overview that is replaced: whole cells of its lattice. The box has two samples
/// more than these need.
struct PatchChoice : stream::DetailBox {
    /// Planes between cells of the overview, in its index space; infinite where the data end.
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();

    bool operator==(const PatchChoice&) const = default;
};

/// A box round what is seen, at the level that the pixels deserve. Where that is too much, only
/// what lies within a view's height of the middle, then a coarser level. Nothing where a finer
/// level than the overview's is not allowed. `interpolation` says where the cells lie.
std::optional<PatchChoice> patch_for(const SeenStore& store, const SeenPoints& seen,
                                     Interpolation interpolation, const DetailLimits& limits);

/// True if this part has all points and is of the level that patch_for() would choose.
bool is_enough(const PatchChoice& patch, const SeenStore& store, const SeenPoints& seen,
               Interpolation interpolation, const DetailLimits& limits);

/// The samples of `fine`, but at the planes of the patch and outside of them those of the field of
/// the overview, and in between within a cell, or four samples if that is less: surfaces extracted
/// from both meet at the planes to within a part of a fine sample.
Volume joined_samples(const Volume& fine, const Field& overview, const PatchChoice& patch);

/// A finer part of what is shown, where the whole is an overview of a store.
struct DetailField {
    Field field;              ///< on a grid of its own, all in memory
    stream::DetailBox of;     ///< where that lies in the store
    Index3 level_size;        ///< samples of the whole level
    std::size_t missing = 0;  ///< pieces that have not come: coarser samples stand in for them
    SampleBox changed = {};   ///< of the field's grid, since the last version of this box

    /// True where the box ends with the data.
    bool at_begin(int axis) const { return of.box.low[axis] == 0; }
    bool at_end(int axis) const { return of.box.high[axis] == level_size[axis] - 1; }
};

/// Makes what slices and scene show of a store more finely, on a thread of its own. Any thread may
/// call any function.
class DetailMaker {
  public:
    /// Three slices, then the scene.
    static constexpr int viewers = 4, scene = 3;
    /// Called from the maker's thread.
    using Made = std::function<void(int viewer, std::shared_ptr<const DetailField>)>;

    /// `overview`: of the store, without edits. `level_sizes`: samples of each level.
    /// `begin_thread`: what the thread does first.
    DetailMaker(const Field& overview, std::vector<Index3> level_sizes, Made made,
                const std::function<void()>& begin_thread);

    /// What was read for a viewer is made next, instead of what was read before.
    void show(int viewer, stream::Detail detail);
    /// The edits of the level that is felt, as often as one likes: whatever they change is made
    /// again. Keeps nothing else of the samples.
    void use_edits(const Samples& felt);
    /// The part of the scene that is wanted; another one is not made.
    void want_patch(const std::optional<PatchChoice>& patch);
    /// Nothing is left to make.
    bool idle() const;

  private:
    struct Place {
        std::optional<stream::Detail> detail;
        SampleBox changed;  ///< of the detail's grid, not made yet
        bool due = false;
        // Of the thread.
        const void* read = nullptr;  ///< the samples that `shown` is for
        std::optional<ShownEdits> shown;
        std::shared_ptr<const Samples> samples, edited;
    };
    /// What is to be made, taken under the lock.
    struct Job {
        int viewer = 0;
        stream::Detail detail;
        SampleBox changed;
        std::shared_ptr<const Samples> edited;
        std::optional<PatchChoice> patch;
    };

    void run(const std::stop_token& stop);
    std::optional<Job> next_job();
    void make(const Job& job);

    const Field overview_;
    const std::vector<Index3> level_sizes_;
    const Made made_;
    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    std::array<Place, viewers> places_;
    std::shared_ptr<const Samples> edited_;  ///< without any brick in memory; null: no edits yet
    std::optional<PatchChoice> patch_;
    bool making_ = false;
    ShownEdits shown_overview_;  // of the thread
    std::jthread thread_;        // last: it uses all of the above
};

}  // namespace palpate::viewer
