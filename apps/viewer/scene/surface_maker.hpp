// Makes the surfaces of a field, at several levels, on a thread of its own: coarse ones first. New
// requests replace older ones.
#pragma once

#include <QObject>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/scene/surface_blocks.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

struct SurfaceLimits {
    std::size_t most_triangles = 6'000'000;  ///< some 0.5 GB; larger surfaces are made coarser
    std::size_t moving_triangles = 150'000;  ///< while things move
    std::size_t most_of_others = 2'000'000;  ///< of each level but the first
    std::size_t moving_of_others = 40'000;
    bool coarse_first = true;  ///< false: the full surface at once, or a coarser one if that has
                               ///< too many triangles
};

/// Belongs to the window's thread.
class SurfaceMaker : public QObject {
    Q_OBJECT
  public:
    explicit SurfaceMaker(const SurfaceLimits& limits = {});
    /// Waits for the thread, no longer than a few blocks take.
    ~SurfaceMaker() override;

    /// Takes other data. There are no surfaces until new ones are made, but those of another part
    /// stay meanwhile. `part`: the part of a coarser surface that these replace.
    void set_field(const Field& field, std::vector<double> levels,
                   const std::optional<PatchBounds>& part = {});
    /// Takes another version of the data, on the same grid, with these samples changed. An edit
    /// changes the surfaces that are shown, coarse or fine. If everything has changed, coarse
    /// surfaces are shown first, and fine ones when no more versions follow.
    void update_field(const Field& field, const SampleBox& changed);
    /// Levels that were there before keep their surfaces. Without data it does nothing.
    void set_levels(std::vector<double> levels);
    void clear();
    /// Limits the first level's surface, from the next one on.
    void set_most_triangles(std::size_t triangles) { most_triangles_ = triangles; }
    /// Limits it while things move, from now on.
    void set_moving_triangles(std::size_t triangles);

    /// One for each level, empty before it is first made. Until a new one is made, the older one
    /// stays, so that a surface moves visibly while its level is dragged.
    const std::vector<ExtractedSurface>& surfaces() const { return surfaces_; }
    bool extracting() const { return answered_ < number_; }

  Q_SIGNALS:
    /// surfaces() have changed.
    void made();
    void problem(const QString& what);

  private:
    using Clock = std::chrono::steady_clock;
    /// An order for the thread. Orders that wait are joined.
    struct Request {
        std::uint64_t number = 0;
        std::optional<Field> field;  ///< nothing: forget all
        std::vector<double> levels;
        std::optional<PatchBounds> part;
        bool other = false;  ///< data, or only `changed`
        SampleBox changed;
    };
    /// The surface at a level, as it grows.
    struct Growing {
        double level = 0;
        std::size_t most = 0, quick = 0;      ///< triangles; for pictures of things that move
        std::optional<SurfaceBlocks> shown;   ///< published, or to be brought up to date
        std::optional<SurfaceBlocks> moving;  ///< a coarser one; nothing: `shown` is quick itself
        std::optional<SurfaceBlocks> finer;   ///< under way
        std::vector<int> steps;               ///< to come after `shown`, that of `finer` first
        bool due = false;                     ///< `shown` or `moving` is out of date
        Clock::time_point begun;
        ExtractedSurface made;
    };
    using GoOn = std::function<bool()>;

    void ask(bool other, const SampleBox& changed);

    // Of the thread.
    void run(const std::stop_token& stop);
    void take_up(Request request);
    void take_up_levels();
    void restart(Growing& one, int step);
    Growing* next_work();
    bool is_due() const;
    void work(Growing& one, const GoOn& first_goes_on, const GoOn& finer_goes_on);
    void make_first(Growing& one, const GoOn& go_on);
    bool make_moving(Growing& one, const GoOn& go_on);
    void make_finer(Growing& one, const GoOn& go_on);
    bool is_quick(const Growing& one, const SurfaceBlocks& blocks);
    SurfaceBlocks::Outcome renew(const Growing& one, SurfaceBlocks& blocks, const GoOn& go_on,
                                 std::size_t most);
    void publish(Growing& one);
    void tell();
    void adapt_step();
    std::vector<int> steps() const;
    SurfaceBlocks blocks_of(int every) const;

    const SurfaceLimits limits_;
    std::atomic<std::size_t> most_triangles_, moving_triangles_;
    // Of the window's thread.
    std::optional<Field> field_;
    std::vector<double> levels_;
    std::optional<PatchBounds> part_;
    std::vector<ExtractedSurface> surfaces_;
    std::uint64_t number_ = 0, answered_ = 0, oldest_ = 1;  // of requests

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<Request> next_;
    std::atomic<bool> waiting_ = false, cancelled_ = false;  // a request waits; with other data

    // Of the thread.
    Request request_;  // that is carried out
    std::vector<Growing> growing_;
    std::map<int, CoarseSamples> coarse_;  // of its field, by the step
    bool streaming_ = false;               // large changes come one after the other
    int streaming_step_ = 0;               // at which they are shown; 0: not known
    Clock::time_point begun_;
    std::jthread thread_;  // last: it uses all of the above
};

/// The steps from coarse to full, for a grid of this size: samples for one that is looked at.
std::vector<int> steps_for(const Index3& size);

/// One for each label, as smooth as its mask allows; positions from the middle of the overlay's
/// grid. `progress` may throw to stop.
std::vector<ExtractedSurface> label_surfaces(const Overlay& overlay,
                                             const std::function<void(double part)>& progress);

}  // namespace palpate::viewer
