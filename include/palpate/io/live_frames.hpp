// Live sources: frames that come while one feels them, from this process or, through a file, from
// another. See docs/sequences.md.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "palpate/io/live_file.hpp"
#include "palpate/samples.hpp"

namespace palpate::io {

/// The last few frames of a live source as samples that a session can play: a value for whoever
/// pushes frames, by command::Samples. Played at speed 1 the field lags behind by what the
/// session's time does, and goes evenly from frame to frame.
class LiveWindow {
  public:
    /// Throws std::invalid_argument for fewer than 1.
    explicit LiveWindow(int frames = 4);
    /// Takes the next frame, at its time [s]; the oldest is let go. A time that is not after the
    /// last one starts anew with this frame alone. Throws std::invalid_argument, and stays as it
    /// was, for a time that is not finite or a frame on another grid or of another type.
    std::shared_ptr<const Samples> push(Volume volume, double time);
    std::shared_ptr<const Samples> push(Frame frame);

  private:
    std::size_t most_;
    std::deque<Frame> frames_;
    int number_ = 0;
};

struct LiveSettings {
    double poll_interval = 0.002;                         ///< [s] 0.0001 to 1
    int frames = 4;                                       ///< how many a version holds, from 2
    std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< most that one frame may take
};

/// How a live source does.
struct LiveStatus {
    std::uint64_t frames = 0;  ///< that came
    std::uint64_t missed = 0;  ///< that the writer was too fast for
    double age = 0;       ///< [s] since the last frame came; before it, since the file was opened
    bool ended = false;   ///< the writer said that nothing more comes
    std::string problem;  ///< what is wrong now; empty if nothing
};

/// Follows a live file with a thread of its own. A writer that stalls or dies shows in the status;
/// one that is started again, on the same grid, is followed on.
class LiveFrames {
  public:
    /// Called from the thread, and from the constructor for frames that are there already; must not
    /// throw.
    using OnChange = std::function<void(std::shared_ptr<const Samples>)>;

    /// Throws InputError as LiveReader does, std::invalid_argument for settings out of range.
    explicit LiveFrames(const std::filesystem::path& path, const LiveSettings& settings = {},
                        OnChange on_change = {});
    ~LiveFrames();
    LiveFrames(const LiveFrames&) = delete;
    LiveFrames& operator=(const LiveFrames&) = delete;

    const Geometry& geometry() const { return header_.geometry; }
    SampleType type() const { return header_.type; }
    double interval() const { return header_.interval; }  ///< [s] nominal; 0: unknown
    /// The last frames; null before the first. Any thread.
    std::shared_ptr<const Samples> newest() const;
    /// The same, waiting for the first at most so long [s].
    std::shared_ptr<const Samples> wait(double seconds) const;
    LiveStatus status() const;

  private:
    void run();
    void follow();
    void reopen();
    void tell(const std::string& problem);

    const std::filesystem::path path_;
    const LiveSettings settings_;
    const OnChange on_change_;
    // The thread's own, after the constructor.
    std::unique_ptr<LiveReader> reader_;
    LiveWindow window_;
    int idle_polls_ = 0;
    std::uint64_t missed_before_ = 0;  ///< by readers of files that are gone

    const LiveHeader header_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    std::shared_ptr<const Samples> newest_;
    LiveStatus status_;
    std::chrono::steady_clock::time_point last_;
    bool stop_ = false;

    std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate::io
