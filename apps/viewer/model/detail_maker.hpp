// Makes what slices and scene show of a store more finely, from samples that were read and from
// edits, on a thread of its own.
#pragma once

#include <array>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "apps/viewer/model/detail_choice.hpp"
#include "palpate/stream/detail.hpp"

namespace palpate::viewer {

/// Any thread may call any function.
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
