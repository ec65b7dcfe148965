// The frame loader. Places count frames over all laps: frame 2 of 20 is at place 2, and in lap 3 at
// place 62. The frames wanted are a window of places around the play position.
#include "palpate/io/frame_loader.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

namespace palpate::io {
namespace {

/// Thrown through a reader to cancel it.
struct Stopped {};

std::int64_t lap_of(std::int64_t place, std::int64_t count) {
    return place >= 0 ? place / count : -((count - 1 - place) / count);
}

std::string mebibytes(std::uint64_t bytes) {
    return std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB";
}

/// How many frames may be wanted at a time. One fewer than fit, if there are enough: during play
/// the player still holds the version before, with the frame that was dropped.
std::int64_t room_for(const Sequence& sequence, const LoaderSettings& settings) {
    check(sequence);
    const std::uint64_t bytes = sequence.frame_bytes();
    const auto fit = static_cast<std::int64_t>(settings.memory_bytes / bytes);
    const std::int64_t count = sequence.count();
    const std::int64_t needed = std::min<std::int64_t>(count, 2);
    if (fit < needed) {
        throw std::invalid_argument("the memory for frames is " + mebibytes(settings.memory_bytes) +
                                    ", but " + std::to_string(needed) + " frames take " +
                                    mebibytes(static_cast<std::uint64_t>(needed) * bytes) +
                                    "; allow at least that");
    }
    if (fit >= count) return count;
    return fit >= 4 ? fit - 1 : fit;
}

}  // namespace

/// Messages of other threads to the loader's thread: the play position, and that memory is free.
/// Frames that outlive the loader keep this alive.
struct FrameLoader::Control {
    std::mutex mutex;
    std::condition_variable changed;
    std::uint64_t changes = 0;
    std::atomic<bool> stop{false};
    bool retry = false;
    bool settled = false;
    double time = 0;
    int direction = 1;  ///< of play; -1: backwards
    std::uint64_t bytes = 0;

    void tell(const std::lock_guard<std::mutex>&) {
        ++changes;
        changed.notify_all();
    }
};

/// A frame that counts for as long as it is held.
struct FrameLoader::Held {
    Held(std::shared_ptr<Control> of, std::uint64_t amount)
        : control(std::move(of)), bytes(amount) {
        const std::lock_guard lock(control->mutex);
        control->bytes += bytes;
    }
    ~Held() {
        volume.reset();
        const std::lock_guard lock(control->mutex);
        control->bytes -= bytes;
        control->tell(lock);
    }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;

    std::shared_ptr<Control> control;
    std::uint64_t bytes;
    std::optional<Volume> volume;
};

/// The frames wanted for a play position.
struct FrameLoader::View {
    std::int64_t at = 0;     ///< the frame that play is at or after
    std::int64_t low = 0;    ///< the window
    std::int64_t high = 0;   ///< in it
    std::int64_t first = 0;  ///< to be read first
    int direction = 1;
};

FrameLoader::FrameLoader(Sequence sequence, const LoaderSettings& settings, OnChange on_change)
    : sequence_(std::move(sequence)),
      settings_(settings),
      on_change_(std::move(on_change)),
      frame_bytes_(sequence_.frame_bytes()),
      room_(room_for(sequence_, settings_)),
      control_(std::make_shared<Control>()) {
    control_->time = sequence_.times.front();
    thread_ = std::thread([this] { run(); });
}

FrameLoader::~FrameLoader() {
    {
        const std::lock_guard lock(control_->mutex);
        control_->stop = true;
        control_->tell(lock);
    }
    thread_.join();
}

void FrameLoader::look(double time, double speed) noexcept {
    // Beyond any real play position; places would not fit into 64 bit.
    if (!(std::abs(time) < 1e12) || std::isnan(speed)) return;
    const std::lock_guard lock(control_->mutex);
    const int direction = speed > 0 ? 1 : speed < 0 ? -1 : control_->direction;
    if (time == control_->time && direction == control_->direction) return;
    control_->time = time;
    control_->direction = direction;
    control_->settled = false;
    control_->tell(lock);
}

std::shared_ptr<const Samples> FrameLoader::newest() const {
    const std::lock_guard lock(newest_mutex_);
    return newest_;
}

LoaderStatus FrameLoader::status() const {
    LoaderStatus status;
    {
        const std::lock_guard lock(control_->mutex);
        status.bytes = control_->bytes;
        status.settled = control_->settled;
    }
    const std::lock_guard lock(newest_mutex_);
    status.frames = frames_;
    status.problem = problem_;
    return status;
}

void FrameLoader::retry() {
    const std::lock_guard lock(control_->mutex);
    control_->retry = true;
    control_->settled = false;
    control_->tell(lock);
}

double FrameLoader::time_at(std::int64_t place) const {
    const std::int64_t count = sequence_.count();
    const std::int64_t lap = lap_of(place, count);
    return sequence_.times[static_cast<std::size_t>(place - lap * count)] +
           static_cast<double>(lap) * sequence_.period;
}

FrameLoader::View FrameLoader::view_of(double time, int direction) const {
    const std::int64_t count = sequence_.count();
    const double begin = sequence_.times.front();
    double lap = 0;
    if (settings_.loop) lap = std::floor((time - begin) / sequence_.period);
    const double within = time - lap * sequence_.period;
    const auto after = std::upper_bound(sequence_.times.begin(), sequence_.times.end(), within);
    const auto frame = std::max<std::int64_t>(after - sequence_.times.begin() - 1, 0);
    View view;
    view.direction = direction;
    view.at = static_cast<std::int64_t>(lap) * count + frame;
    // The two frames around the play position; frames that cannot be read do not count.
    const auto last = settings_.loop ? std::numeric_limits<std::int64_t>::max() : count - 1;
    const auto begins = settings_.loop ? std::numeric_limits<std::int64_t>::min() : 0;
    std::int64_t from = view.at;
    std::int64_t to = std::min(view.at + 1, last);
    while (has_failed(from) && view.at - from < count && from > begins) --from;
    while (has_failed(to) && to - view.at < count && to < last) ++to;
    const std::int64_t behind = std::max<std::int64_t>(room_ - 2, 0) / 4;
    view.low = direction > 0 ? from - behind : to + 1 + behind - room_;
    if (!settings_.loop) view.low = std::clamp<std::int64_t>(view.low, 0, count - room_);
    view.high = view.low + room_ - 1;
    // They take no room either: for each, the window is a frame longer.
    std::int64_t good = 0;
    for (std::int64_t place = view.low; place <= view.high; ++place) good += !has_failed(place);
    while (good < room_ && view.high - view.low + 1 < count) {
        const bool up = direction > 0 ? view.high < last : view.low <= begins;
        good += !has_failed(up ? ++view.high : --view.low);
    }
    view.first = std::clamp(direction > 0 ? view.at : view.at + 1, view.low, view.high);
    return view;
}

bool FrameLoader::has_failed(std::int64_t place) const {
    const std::int64_t count = sequence_.count();
    return failed_.contains(static_cast<int>(place - lap_of(place, count) * count));
}

/// The first place of a frame from `low` on.
std::int64_t FrameLoader::place_from(std::int64_t low, int frame) const {
    if (!settings_.loop) return frame;
    const std::int64_t count = sequence_.count();
    return frame - lap_of(frame - low, count) * count;
}

/// The place of a frame that is nearest to another place.
std::int64_t FrameLoader::nearest_place(std::int64_t to, int frame) const {
    const std::int64_t after = place_from(to, frame);
    const std::int64_t count = sequence_.count();
    return settings_.loop && 2 * (after - to) > count ? after - count : after;
}

void FrameLoader::run() {
    while (true) {
        std::uint64_t seen = 0;
        View view;
        {
            const std::lock_guard lock(control_->mutex);
            if (control_->stop) return;
            seen = control_->changes;
            view = view_of(control_->time, control_->direction);
            if (std::exchange(control_->retry, false)) {
                failed_.clear();
                tell_problem("");
            }
        }
        forget(view);
        publish(view);
        const int next = next_frame(view);
        if (next >= 0 && there_is_room()) {
            read(next);
        } else {
            wait(seen, next >= 0);
        }
    }
}

bool FrameLoader::is_wanted(const View& view, int frame) const {
    const std::int64_t place = place_from(view.low, frame);
    return view.low <= place && place <= view.high;
}

/// Drops frames that are not wanted, but keeps one to feel as long as there is no other.
void FrameLoader::forget(const View& view) {
    const auto wanted = [&](const auto& entry) { return is_wanted(view, entry.first); };
    const auto away = [&](const auto& entry) {
        return std::abs(nearest_place(view.at, entry.first) - view.at);
    };
    int spare = -1;
    if (!loaded_.empty() && std::none_of(loaded_.begin(), loaded_.end(), wanted)) {
        spare = std::min_element(loaded_.begin(), loaded_.end(), [&](const auto& a, const auto& b) {
                    return away(a) < away(b);
                })->first;
    }
    std::erase_if(loaded_,
                  [&](const auto& entry) { return entry.first != spare && !wanted(entry); });
}

/// The frame to read next; -1: none. From the play position on, then those behind it.
int FrameLoader::next_frame(const View& view) const {
    const std::int64_t count = sequence_.count();
    const auto missing = [&](std::int64_t place) {
        const auto frame = static_cast<int>(place - lap_of(place, count) * count);
        return loaded_.contains(frame) || failed_.contains(frame) ? -1 : frame;
    };
    for (std::int64_t place = view.first; view.low <= place && place <= view.high;
         place += view.direction) {
        if (missing(place) >= 0) return missing(place);
    }
    for (std::int64_t place = view.first; view.low <= place && place <= view.high;
         place -= view.direction) {
        if (missing(place) >= 0) return missing(place);
    }
    return -1;
}

bool FrameLoader::there_is_room() const {
    const std::lock_guard lock(control_->mutex);
    return control_->bytes + frame_bytes_ <= settings_.memory_bytes;
}

void FrameLoader::read(int frame) {
    std::string problem;
    try {
        const auto held = std::make_shared<Held>(control_, frame_bytes_);
        held->volume = read_frame(sequence_, frame, [this](double) {
            if (control_->stop) throw Stopped{};
        });
        // The published frame notices when its last holder drops it.
        loaded_.emplace(
            frame, Volume(sequence_.geometry, sequence_.type,
                          std::shared_ptr<const void>(held, held->volume->data()), frame_bytes_));
        return;
    } catch (const Stopped&) {
        return;
    } catch (const std::bad_alloc&) {
        problem = "frame " + std::to_string(frame) + ": there is not enough memory for it";
    } catch (const std::exception& error) {
        problem = error.what();
    } catch (...) {
        problem = "frame " + std::to_string(frame) + ": could not be read";
    }
    failed_.insert(frame);
    tell_problem(problem);
}

void FrameLoader::tell_problem(const std::string& problem) {
    const std::lock_guard lock(newest_mutex_);
    problem_ = problem;
}

/// The places of the loaded frames around the play position, without gaps except for frames that
/// cannot be read; for a frame that is not wanted, its nearest place.
std::vector<std::int64_t> FrameLoader::run_of_loaded(const View& view) const {
    std::vector<std::int64_t> places;
    for (const auto& [frame, volume] : loaded_) {
        places.push_back(is_wanted(view, frame) ? place_from(view.low, frame)
                                                : nearest_place(view.at, frame));
    }
    if (places.size() < 2) return places;
    std::sort(places.begin(), places.end());
    const auto nearest =
        std::min_element(places.begin(), places.end(), [&](std::int64_t a, std::int64_t b) {
            return std::abs(a - view.at) < std::abs(b - view.at);
        });
    const auto joined = [&](std::int64_t from, std::int64_t to) {
        for (std::int64_t place = from + 1; place < to; ++place) {
            if (!has_failed(place)) return false;
        }
        return true;
    };
    auto first = nearest, last = nearest;
    while (first != places.begin() && joined(*(first - 1), *first)) --first;
    while (last + 1 != places.end() && joined(*last, *(last + 1))) ++last;
    return {first, last + 1};
}

/// A version of the loaded frames; `period` is 0 if it is a part of the sequence.
std::vector<Frame> FrameLoader::frames_for(const View& view, double& period) const {
    std::vector<Frame> frames;
    const std::int64_t count = sequence_.count();
    const bool whole = static_cast<std::int64_t>(loaded_.size() + failed_.size()) >= count &&
                       room_ == count && settings_.loop;
    period = whole ? sequence_.period : 0;
    if (whole) {
        for (const auto& [frame, volume] : loaded_) {
            frames.push_back({time_at(frame), volume, frame});
        }
        return frames;
    }
    for (const std::int64_t place : run_of_loaded(view)) {
        const auto frame = static_cast<int>(place - lap_of(place, count) * count);
        frames.push_back({time_at(place), loaded_.at(frame), frame});
    }
    return frames;
}

/// Publishes the version if it differs from the last, or if the player seems to wait for another.
void FrameLoader::publish(const View& view) {
    double period = 0;
    std::vector<Frame> frames = frames_for(view, period);
    if (frames.empty()) return;
    std::vector<double> key{period};
    for (const Frame& frame : frames) key.push_back(frame.time);
    if (key == published_ && Clock::now() < reminder_) return;
    reminders_ = key == published_ ? std::min(reminders_ + 1, 6) : 0;
    published_ = std::move(key);
    const auto samples = std::make_shared<const Samples>(std::move(frames), period);
    {
        std::shared_ptr<const Samples> last = samples;  // dies after the lock
        const std::lock_guard lock(newest_mutex_);
        newest_.swap(last);
        frames_ = static_cast<int>(loaded_.size());
    }
    if (on_change_) on_change_(samples);
    reminder_ = Clock::time_point::max();
}

/// Waits until something has changed since `seen`, or, while waiting for memory, until it is time
/// to publish again: the player may drop the version before only when another one comes.
void FrameLoader::wait(std::uint64_t seen, bool for_memory) {
    std::unique_lock lock(control_->mutex);
    const auto changed = [&] { return control_->changes != seen; };
    if (!for_memory) {
        control_->settled = !changed();
        control_->changed.wait(lock, changed);
        return;
    }
    if (reminder_ == Clock::time_point::max()) {
        reminder_ = Clock::now() + std::chrono::milliseconds(20 << reminders_);
    }
    control_->changed.wait_until(lock, reminder_, changed);
}

}  // namespace palpate::io
