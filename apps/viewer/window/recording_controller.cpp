// Starts and ends recordings, tells what is special about one that is played, and passes requests
// of the timeline to the player or the clock.
#include "apps/viewer/window/recording_controller.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/messages.hpp"
#include "io/system/system.hpp"

namespace palpate::viewer {

RecordingController::RecordingController(const Desk& desk)
    : Controller(desk), preparing_(messages_), ending_(messages_) {
    connect(&content_, &Content::closing, this, [this] {
        preparing_.abandon();
        if (recording()) recorded_ = std::max(0.0, seconds() - began_);
        records_ = false;
    });
    connect(&content_, &Content::runs_ended, this, &RecordingController::tell_runs_ended);
    connect(&content_, &Content::run_changed, this, &RecordingController::tell_end);
    connect(&content_, &Content::playback_started, this, &RecordingController::tell_playback);
}

namespace {

/// Keeps a pipe open that has a reader. For files it is empty.
class HeldPipe {
  public:
    HeldPipe(const std::filesystem::path& path, const std::function<void()>& wait) {
        std::error_code error;
        const bool is_pipe = std::filesystem::is_fifo(path, error);
        if (is_pipe) descriptor_ = io::open_to_write(path, wait);
    }
    ~HeldPipe() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    HeldPipe(const HeldPipe&) = delete;
    HeldPipe& operator=(const HeldPipe&) = delete;

  private:
    int descriptor_ = -1;
};

}  // namespace

void RecordingController::start(const QString& path) {
    if (!content_.live()) return;
    const auto pipe = std::make_shared<std::unique_ptr<HeldPipe>>();
    const std::filesystem::path file(path.toStdString());
    preparing_.start(
        tr("Preparing to record to %1").arg(short_name(path)),
        [data = content_.data(), file, pipe](const io::Progress& progress) {
            (void)data->identity([&](double part) { progress(part); });
            *pipe = std::make_unique<HeldPipe>(file, [&] { progress(1); });
        },
        [this, path, pipe] { begin(path); });
}

/// Once that takes no time any more.
void RecordingController::begin(const QString& path) {
    if (!content_.live()) return;
    messages_.guarded([&] {
        std::vector<run::Run*> hands;
        for (int hand = 1; hand <= content_.hands(); ++hand) hands.push_back(content_.live(hand));
        run::Run::record_together(hands, path.toStdString());
        began_ = seconds();
        recorded_ = 0;
        records_ = true;
        messages_.show_done(tr("Recording to %1").arg(path));
    });
    Q_EMIT changed();
}

void RecordingController::stop() {
    preparing_.abandon();
    if (!recording()) return;
    records_ = false;
    const double recorded = std::max(0.0, seconds() - began_);
    const int before = std::exchange(exit_status_, app::bad_output);  // unless it is whole
    std::vector<run::Run::FinishRecording> hands;
    for (int hand = 1; hand <= content_.hands(); ++hand) {
        hands.push_back(content_.live(hand)->end_recording());
    }
    ending_.start(
        tr("Finishing the recording"),
        [hands](const io::Progress& progress) {
            std::exception_ptr lost;
            for (const auto& finish : hands) {
                try {
                    finish([&](double) { progress(0); });
                } catch (...) {  // also of `progress`
                    lost = std::current_exception();
                }
            }
            if (lost) std::rethrow_exception(lost);
        },
        [this, before, recorded] {
            tell_recorded(recorded);
            exit_status_ = before;
        });
    Q_EMIT changed();
}

void RecordingController::finish() {
    ending_.end_within(std::chrono::milliseconds(500));
}

void RecordingController::tell_recorded(double seconds) {
    messages_.show_done(tr("Recorded %1 s").arg(seconds, 0, 'f', 1));
}

/// With the runs, their recording ended.
void RecordingController::tell_runs_ended(const RunCloser::Ended& how) {
    if (!how.lost.empty()) {
        exit_status_ = app::bad_output;
        messages_.show_problem(QString::fromStdString(how.lost), exit_status_);
    } else if (how.recorded && recorded_ > 0) {
        tell_recorded(recorded_);
    }
    recorded_ = 0;
    Q_EMIT changed();
}

/// Another device, other buttons or another field end the recording: a session begins anew.
void RecordingController::tell_end() {
    if (!records_ || recording()) return;
    records_ = false;
    messages_.show_done(tr("Recorded up to this change: the session began anew"));
    Q_EMIT changed();
}

/// Of the first hand, since its run began.
double RecordingController::seconds() const {
    const auto now = content_.live(1)->snapshot();
    return now ? now->session.tick.time : 0;
}

/// Of the hands that are recorded, all have the same. Null: nothing is recorded.
const io::RecordingWriter* RecordingController::writer() const {
    for (int hand = 1; hand <= content_.hands(); ++hand) {
        const run::Run* live = content_.live(hand);
        if (live && live->recording()) return live->recording();
    }
    return nullptr;
}

void RecordingController::check() {
    if (recording() && !writer()->problem().empty()) stop();
    tell_end();
}

void RecordingController::tell_playback() {
    const Playback& playback = *content_.playback();
    std::size_t different = 0;
    for (int hand = 1; hand <= content_.hands(); ++hand) {
        different += content_.playback(hand)->different();
    }
    QStringList words{tr("A recording of %1 s").arg(playback.end() - playback.begin(), 0, 'f', 1)};
    if (content_.hands() < playback.hands()) {
        words
            << tr("the first %1 of %2 hands are shown").arg(content_.hands()).arg(playback.hands());
    }
    if (!playback.complete()) words << tr("the recording was cut off before its end");
    if (different > 0) {
        words << tr("%n ticks come out otherwise than they were recorded", nullptr,
                    static_cast<int>(different));
    }
    messages_.show_done(words.join("; "));
}

TimelineController::TimelineController(const Desk& desk, Timeline& timeline)
    : Controller(desk), timeline_(timeline) {
    connect_timeline();
    connect(&content_, &Content::closed, &timeline_, &QWidget::hide);
    connect(&content_, &Content::run_changed, this, &TimelineController::show);
    connect(&content_, &Content::playback_started, this, [this] {
        recorded_ = {};
        show_hand();
    });
    connect(&content_, &Content::hand_changed, this, [this] {
        if (content_.playback()) show_hand();
    });
    timeline_.hide();
    since_.start();
}

void TimelineController::connect_timeline() {
    // Both can play, seek and loop.
    const auto ask = [this](auto&& action) {
        if (run::Player* player = content_.player()) {
            messages_.guarded([&] { action(*player); });
        } else if (content_.playback()) {
            action(recorded_);
            content_.set_time(recorded_.time);
        }
        timeline_.set_view(view());
    };
    connect(&timeline_, &Timeline::speed_asked, this,
            [ask](double speed) { ask([speed](auto& player) { player.play(speed); }); });
    connect(&timeline_, &Timeline::moment_asked, this,
            [ask](double time) { ask([time](auto& player) { player.seek(time); }); });
    connect(&timeline_, &Timeline::loop_asked, this,
            [ask](bool loop) { ask([loop](auto& player) { player.set_loop(loop); }); });
}

TimelineView TimelineController::view() const {
    if (const run::Player* player = content_.player()) return TimelineView(player->state());
    return content_.playback() ? recorded_ : TimelineView();
}

/// The times are those of the chosen hand; the clock goes on.
void TimelineController::show_hand() {
    const Playback& playback = *content_.playback();
    recorded_.begin = playback.begin();
    recorded_.end = playback.end();
    recorded_.seek(content_.time());
    recorded_.overview = std::make_shared<Overview>(playback.overview());
    show();
}

void TimelineController::show() {
    timeline_.setVisible(content_.player() || content_.playback());
    if (!timeline_.isHidden()) timeline_.set_view(view());
}

void TimelineController::show_time(double time) {
    if (!content_.playback()) return;
    recorded_.seek(time);
    content_.set_time(recorded_.time);
    timeline_.set_view(view());
}

void TimelineController::advance() {
    const double passed = 1e-9 * static_cast<double>(since_.nsecsElapsed());
    since_.restart();
    if (!content_.playback() || timeline_.dragging()) return;
    recorded_.advance(passed);
    content_.set_time(recorded_.time);
}

void TimelineController::observe() {
    if (timeline_.isHidden()) return;
    timeline_.set_view(view());
    if (!content_.player()) return;
    const QString problem = QString::fromStdString(content_.player()->state().problem);
    if (problem != std::exchange(problem_, problem) && !problem.isEmpty()) {
        messages_.show_problem(problem);
    }
}

}  // namespace palpate::viewer
