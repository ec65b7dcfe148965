// Starts and ends recordings, and tells what is special about one that is played.
#include "apps/viewer/window/recording_controller.hpp"

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
        messages_.show_done(tr("Recording to %1").arg(path));
    });
    Q_EMIT changed();
}

void RecordingController::stop() {
    if (!recording()) return;
    messages_.guarded([&] {
        const int before = std::exchange(exit_status_, app::bad_output);  // unless it is whole
        messages_.show_done(
            tr("%n ticks recorded", nullptr, static_cast<int>(content_.live()->stop_recording())));
        exit_status_ = before;
    });
    Q_EMIT changed();
}

bool RecordingController::recording() const {
    return content_.live() && content_.live()->recording();
}

void RecordingController::check() {
    if (recording() && !content_.live()->recording()->problem().empty()) stop();
}

void RecordingController::tell_playback() {
    const Playback& playback = *content_.playback();
    QStringList words{tr("%n ticks", nullptr, static_cast<int>(playback.ticks()))};
    if (!playback.complete()) words << tr("the recording was cut off before its end");
    if (playback.different() > 0) {
        words << tr("%n of them come out otherwise than they were recorded", nullptr,
                    static_cast<int>(playback.different()));
    }
    messages_.show_done(words.join("; "));
}

}  // namespace palpate::viewer
