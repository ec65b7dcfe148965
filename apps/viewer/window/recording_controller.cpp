// Starts and ends recordings, and tells what is special about one that is played.
#include "apps/viewer/window/recording_controller.hpp"

#include <exception>
#include <utility>
#include <vector>

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
        std::vector<run::Run*> hands;
        for (int hand = 1; hand <= content_.hands(); ++hand) hands.push_back(content_.live(hand));
        run::Run::record_together(hands, path.toStdString());
        messages_.show_done(tr("Recording to %1").arg(path));
    });
    Q_EMIT changed();
}

void RecordingController::stop() {
    if (!recording()) return;
    messages_.guarded([&] {
        const int before = std::exchange(exit_status_, app::bad_output);  // unless it is whole
        std::int64_t ticks = 0;
        std::exception_ptr lost;
        for (int hand = 1; hand <= content_.hands(); ++hand) {
            try {
                ticks += content_.live(hand)->stop_recording();
            } catch (const io::OutputError&) {
                lost = std::current_exception();
            }
        }
        if (lost) std::rethrow_exception(lost);
        messages_.show_done(tr("%n ticks recorded", nullptr, static_cast<int>(ticks)));
        exit_status_ = before;
    });
    Q_EMIT changed();
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
}

void RecordingController::tell_playback() {
    std::size_t ticks = 0, different = 0;
    for (int hand = 1; hand <= content_.hands(); ++hand) {
        ticks += content_.playback(hand)->ticks();
        different += content_.playback(hand)->different();
    }
    QStringList words{tr("%n ticks", nullptr, static_cast<int>(ticks))};
    if (content_.hands() < content_.playback()->hands()) {
        words << tr("the first %1 of %2 hands are shown")
                     .arg(content_.hands())
                     .arg(content_.playback()->hands());
    }
    if (!content_.playback()->complete()) words << tr("the recording was cut off before its end");
    if (different > 0) {
        words << tr("%n of them come out otherwise than they were recorded", nullptr,
                    static_cast<int>(different));
    }
    messages_.show_done(words.join("; "));
}

}  // namespace palpate::viewer
