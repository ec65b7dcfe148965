// Starts and ends recordings, and tells what is special about one that is played.
#include "apps/viewer/window/recording_controller.hpp"

#include <algorithm>
#include <utility>

#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {

RecordingController::RecordingController(Content& content, Messages& messages)
    : content_(content), messages_(messages) {
    connect(&content, &Content::closing, this, &RecordingController::stop);
    connect(&content, &Content::playback_started, this, &RecordingController::tell_playback);
}

void RecordingController::start(const QString& path) {
    if (!content_.live()) return;
    messages_.guarded([&] {
        content_.live()->record(path.toStdString());
        began_ = seconds();
        messages_.show_done(tr("Recording to %1").arg(path));
    });
    Q_EMIT changed();
}

void RecordingController::stop() {
    if (!recording()) return;
    messages_.guarded([&] {
        const int before = std::exchange(exit_status_, app::bad_output);  // unless it is whole
        const double recorded = std::max(0.0, seconds() - began_);
        content_.live()->stop_recording();
        messages_.show_done(tr("Recorded %1 s").arg(recorded, 0, 'f', 1));
        exit_status_ = before;
    });
    Q_EMIT changed();
}

/// Since the run began.
double RecordingController::seconds() const {
    const auto now = content_.live()->snapshot();
    return now ? now->session.tick.time : 0;
}

bool RecordingController::recording() const {
    return content_.live() && content_.live()->recording();
}

void RecordingController::check() {
    if (recording() && !content_.live()->recording()->problem().empty()) stop();
}

void RecordingController::tell_playback() {
    const Playback& playback = *content_.playback();
    QStringList words{tr("A recording of %1 s").arg(playback.end() - playback.begin(), 0, 'f', 1)};
    if (!playback.complete()) words << tr("the recording was cut off before its end");
    if (playback.different() > 0) {
        words << tr("%n ticks come out otherwise than they were recorded", nullptr,
                    static_cast<int>(playback.different()));
    }
    messages_.show_done(words.join("; "));
}

}  // namespace palpate::viewer
