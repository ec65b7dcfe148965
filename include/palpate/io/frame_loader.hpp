// Reads the frames of a sequence ahead of the play position, in a thread of its own, and keeps
// those around it in memory within a limit. See docs/sequences.md.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "palpate/io/sequence.hpp"
#include "palpate/samples.hpp"

namespace palpate::io {

struct LoaderSettings {
    /// [bytes] Memory limit of all frames: those in the loader, the one being read, and those that
    /// are held only by versions that it has published.
    std::uint64_t memory_bytes = std::uint64_t{1} << 30;
    bool loop = true;  ///< the first frame follows the last
};

struct LoaderStatus {
    int frames = 0;           ///< in the loader
    std::uint64_t bytes = 0;  ///< of all frames, wherever they are held
    /// True if every frame that was needed at the last call of look() is loaded or cannot be read.
    bool settled = false;
    /// Why frames are missing: the error of the last frame that could not be read. Empty if there
    /// is none.
    std::string problem;
};

/// Once all frames are read, if they fit, it publishes the whole sequence with its period.
/// Otherwise, and before that, it publishes the part around the play position, without a period.
/// Its times do not jump when the sequence begins again: the first frame of lap 3 is at 3 periods.
class FrameLoader {
  public:
    /// Called from the loader's thread; must not throw.
    using OnChange = std::function<void(std::shared_ptr<const Samples>)>;

    /// Throws std::invalid_argument for a sequence that is not valid, or if two of its frames do
    /// not fit into the memory.
    explicit FrameLoader(Sequence sequence, const LoaderSettings& settings = {},
                         OnChange on_change = {});
    /// Cancels a frame that is being read.
    ~FrameLoader();
    FrameLoader(const FrameLoader&) = delete;
    FrameLoader& operator=(const FrameLoader&) = delete;

    /// Sets the play position: the session's time of the sequence [s], laps included, and its
    /// speed. At speed 0 the last direction counts. Any thread; never waits for a read.
    void look(double time, double speed) noexcept;
    /// The newest version; null before the first frame is read. Any thread. The player should take
    /// each one soon and release the one before, because frames that only old versions hold take
    /// memory.
    std::shared_ptr<const Samples> newest() const;
    LoaderStatus status() const;
    /// LoaderStatus::problem.
    std::string problem() const { return status().problem; }
    /// Tries again to read the frames that could not be read.
    void retry();

  private:
    struct Control;
    struct Held;
    struct View;

    using Clock = std::chrono::steady_clock;

    void run();
    void wait(std::uint64_t seen, bool for_memory);
    void forget(const View& view);
    int next_frame(const View& view) const;
    bool there_is_room() const;
    void read(int frame);
    void tell_problem(const std::string& problem);
    void publish(const View& view);
    std::vector<Frame> frames_for(const View& view, double& period) const;
    std::vector<std::int64_t> run_of_loaded(const View& view) const;
    bool is_wanted(const View& view, int frame) const;
    std::int64_t place_from(std::int64_t low, int frame) const;
    std::int64_t nearest_place(std::int64_t to, int frame) const;
    double time_at(std::int64_t place) const;
    View view_of(double time, int direction) const;
    bool has_failed(std::int64_t place) const;

    const Sequence sequence_;
    const LoaderSettings settings_;
    const OnChange on_change_;
    const std::uint64_t frame_bytes_;
    const std::int64_t room_;  ///< frames at a time
    const std::shared_ptr<Control> control_;

    // Used by the thread only.
    std::map<int, Volume> loaded_;
    std::set<int> failed_;
    std::vector<double> published_;  ///< period and times of the published version
    Clock::time_point reminder_ = Clock::time_point::max();  ///< when it is published again
    int reminders_ = 0;

    mutable std::mutex newest_mutex_;
    std::shared_ptr<const Samples> newest_;
    int frames_ = 0;
    std::string problem_;

    std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate::io
