// Starts and ends recordings, and tells what is special about one that is played.
#include "apps/viewer/window/recording_controller.hpp"

#include <algorithm>
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
        std::exception_ptr lost;
        for (int hand = 1; hand <= content_.hands(); ++hand) {
            try {
                content_.live(hand)->stop_recording();
            } catch (const io::OutputError&) {
                lost = std::current_exception();
            }
        }
        if (lost) std::rethrow_exception(lost);
        messages_.show_done(tr("Recorded %1 s").arg(recorded, 0, 'f', 1));
        exit_status_ = before;
    });
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

}  // namespace palpate::viewer
