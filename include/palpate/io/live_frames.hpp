// Live sources: frames that arrive while they are touched, from this process or, through a file,
// from another one. See docs/sequences.md.
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
#include "palpate/servo.hpp"

namespace palpate::io {

/// The last few frames of a live source as samples that a session can play. Code that pushes frames
/// adds them here and sends the result with command::Samples. Played at speed 1 the field lags by
/// as much as the session's time does, and moves evenly from frame to frame.
class LiveWindow {
  public:
    /// Throws std::invalid_argument for fewer than 1.
    explicit LiveWindow(int frames = 4);
    /// Adds the next frame, at its time [s], and drops the oldest. A time that is not after the
    /// last one begins a new sequence with this frame alone. Throws std::invalid_argument, and
    /// stays as it was, for a time that is not finite or a frame on another grid or of another
    /// type.
    std::shared_ptr<const Samples> push(Volume volume, double time);
    std::shared_ptr<const Samples> push(Frame frame);

  private:
    std::size_t most_;
    std::deque<Frame> frames_;
    int number_ = 0;
};

struct LiveSettings {
    double poll_interval = 0.002;  ///< [s] 0.0001 to 1
    int frames = 4;                ///< number of frames that a version holds, from 2
    std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< most that one frame may take
};

/// State of a live source.
struct LiveStatus {
    std::uint64_t frames = 0;  ///< received
    std::uint64_t missed = 0;  ///< overwritten before they were read
    double age = 0;            ///< [s] since the last frame, or since the file was opened
    bool ended = false;        ///< the writer has marked the file as ended
    std::string problem;       ///< the present problem, or empty
};

/// Follows a live file. The status shows whether the writer stalls or has died. If a writer is
/// started again on the same grid, its frames follow.
class LiveFrames {
  public:
    /// Called from step(), and from the constructor for frames that exist already. Must not
    /// throw.
    using OnChange = std::function<void(std::shared_ptr<const Samples>)>;

    /// Throws InputError as LiveReader does, std::invalid_argument for settings out of range.
    explicit LiveFrames(const std::filesystem::path& path, const LiveSettings& settings = {},
                        OnChange on_change = {}, Pace pace = Pace::own_thread);
    ~LiveFrames();
    LiveFrames(const LiveFrames&) = delete;
    LiveFrames& operator=(const LiveFrames&) = delete;

    /// Reads the new frames and publishes one version with them; its thread calls this every
    /// `poll_interval`.
    void step(std::chrono::steady_clock::time_point now);
    const Geometry& geometry() const { return header_.geometry; }
    SampleType type() const { return header_.type; }
    double interval() const { return header_.interval; }  ///< [s] nominal; 0: unknown
    /// The last frames; null before the first. Any thread.
    std::shared_ptr<const Samples> newest() const;
    /// The same, but waits for the first frame for this long at most [s], or until `progress`
    /// throws.
    std::shared_ptr<const Samples> wait(double seconds, const OnProgress& progress = {}) const;
    LiveStatus status(
        std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now()) const;

  private:
    void reopen();
    void tell(const std::string& problem);

    const std::filesystem::path path_;
    const LiveSettings settings_;
    const OnChange on_change_;
    // Used by step() only, after the constructor.
    std::unique_ptr<LiveReader> reader_;
    LiveWindow window_;
    int idle_polls_ = 0;
    std::uint64_t missed_before_ = 0;  ///< by readers of earlier files

    const LiveHeader header_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    std::shared_ptr<const Samples> newest_;
    LiveStatus status_;
    std::chrono::steady_clock::time_point last_;

    std::jthread thread_;  // last: it uses all of the above
};

}  // namespace palpate::io
