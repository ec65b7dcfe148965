// Live sources: the window of the last frames, and the thread that follows a live file.
#include "palpate/io/live_frames.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "io/system/stepping_thread.hpp"

namespace palpate::io {
namespace {

/// After this many polls without a frame, checks whether another file has the name.
constexpr int polls_until_suspicion = 50;

LiveSettings checked(const LiveSettings& settings) {
    if (!(settings.poll_interval >= 1e-4 && settings.poll_interval <= 1)) {
        throw std::invalid_argument("a live source is looked at every 0.0001 to 1 s");
    }
    if (settings.frames < 2) throw std::invalid_argument("a live source needs at least 2 frames");
    return settings;
}

}  // namespace

LiveWindow::LiveWindow(int frames) : most_(static_cast<std::size_t>(frames)) {
    if (frames < 1) throw std::invalid_argument("a window needs at least one frame");
}

std::shared_ptr<const Samples> LiveWindow::push(Volume volume, double time) {
    return push(Frame{time, std::move(volume), number_});
}

std::shared_ptr<const Samples> LiveWindow::push(Frame frame) {
    if (!std::isfinite(frame.time)) {
        throw std::invalid_argument("the time of a frame is not finite");
    }
    std::deque<Frame> frames = frames_;
    if (!frames.empty()) {
        const Volume& last = frames.back().volume;
        if (!(frame.volume.geometry() == last.geometry()) || frame.volume.type() != last.type()) {
            throw std::invalid_argument("a frame does not lie on the grid of those before");
        }
        if (!(frame.time > frames.back().time)) frames.clear();
    }
    frames.push_back(std::move(frame));
    if (frames.size() > most_) frames.pop_front();
    auto samples =
        std::make_shared<const Samples>(std::vector<Frame>(frames.begin(), frames.end()));
    frames_ = std::move(frames);
    ++number_;
    return samples;
}

LiveFrames::LiveFrames(const std::filesystem::path& path, const LiveSettings& settings,
                       OnChange on_change, Pace pace)
    : path_(path),
      settings_(checked(settings)),
      on_change_(std::move(on_change)),
      reader_(std::make_unique<LiveReader>(path, settings.memory_bytes)),
      window_(settings.frames),
      header_(reader_->header()),
      last_(std::chrono::steady_clock::now()) {
    step(last_);
    if (pace == Pace::by_steps) return;
    thread_ = stepping_thread(
        std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * settings_.poll_interval)),
        [this](SteadyTime now) { step(now); });
}

LiveFrames::~LiveFrames() = default;

std::shared_ptr<const Samples> LiveFrames::newest() const {
    const std::lock_guard lock(mutex_);
    return newest_;
}

std::shared_ptr<const Samples> LiveFrames::wait(double seconds, const OnProgress& progress) const {
    constexpr double between = 0.02;  // [s] two reports of progress
    for (double waited = 0;; waited += between) {
        {
            std::unique_lock lock(mutex_);
            changed_.wait_for(lock, std::chrono::duration<double>(between),
                              [this] { return newest_ != nullptr; });
            if (newest_ || waited >= seconds) return newest_;
        }
        if (progress) progress(waited / seconds);
    }
}

LiveStatus LiveFrames::status(SteadyTime now) const {
    const std::lock_guard lock(mutex_);
    LiveStatus status = status_;
    status.age = std::chrono::duration<double>(now - last_).count();
    return status;
}

void LiveFrames::tell(const std::string& problem) {
    const std::lock_guard lock(mutex_);
    status_.problem = problem;
}

/// One version with all that is new.
void LiveFrames::step(SteadyTime now) {
    try {
        std::vector<Frame> frames = reader_->poll(settings_.frames);
        std::shared_ptr<const Samples> samples;
        const std::size_t count = frames.size();
        for (Frame& frame : frames) samples = window_.push(std::move(frame));
        {
            const std::lock_guard lock(mutex_);
            status_.missed = missed_before_ + reader_->missed();
            status_.ended = reader_->ended();
            if (samples) {
                status_.frames += count;
                status_.problem.clear();
                last_ = now;
                std::swap(newest_, samples);  // the old one dies after the lock
            }
        }
        idle_polls_ = count > 0 ? 0 : idle_polls_ + 1;
        if (count > 0) {
            changed_.notify_all();
            if (on_change_) on_change_(newest());
        }
    } catch (const std::exception& error) {
        tell(error.what());
        ++idle_polls_;
    }
    if (idle_polls_ < polls_until_suspicion) return;
    idle_polls_ = 0;
    if (reader_->replaced()) reopen();
}

void LiveFrames::reopen() {
    try {
        auto reader = std::make_unique<LiveReader>(path_, settings_.memory_bytes);
        const LiveHeader& header = reader->header();
        if (!(header.geometry == header_.geometry) || header.type != header_.type) {
            tell(path_.string() + ": was replaced by a source on another grid; open it again");
            return;
        }
        missed_before_ += reader_->missed();
        reader_ = std::move(reader);
    } catch (const std::exception& error) {
        tell(error.what());
    }
}

}  // namespace palpate::io
