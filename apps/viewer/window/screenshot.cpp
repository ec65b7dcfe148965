// Waits until everything is drawn, then saves the picture.
#include "apps/viewer/window/screenshot.hpp"

#include "apps/options/exit_status.hpp"
#include "apps/viewer/window/main_window.hpp"

namespace palpate::viewer {
namespace {

constexpr int look_ms = 50;
/// How many checks in a row must find nothing in progress.
constexpr int quiet_looks = 6;

}  // namespace

Screenshot::Screenshot(MainWindow& window, const QString& path, double after)
    : window_(window), path_(path), after_(after) {
    connect(&timer_, &QTimer::timeout, this, &Screenshot::look);
    timer_.start(look_ms);
}

/// Whether the time of the picture has come; the hand is held there from then on.
bool Screenshot::reached() {
    if (const Playback* playback = window_.playback()) {
        if (!held_) window_.playing().show_time(playback->begin() + after_);
        held_ = true;
        return true;
    }
    const run::Run* live = window_.live();
    const auto now = live ? live->snapshot() : std::nullopt;
    if (!now) return false;
    if (!held_ && now->session.tick.time >= after_ && !window_.probe().travelling()) {
        window_.display().hold();
        held_ = true;
    }
    return held_;
}

void Screenshot::look() {
    if (!window_.messages().problem().isEmpty()) {
        status_ = window_.messages().problem_status();  // the window has shown why
        window_.close();
        return;
    }
    quiet_ = reached() && window_.settled() ? quiet_ + 1 : 0;
    if (quiet_ < quiet_looks) return;
    timer_.stop();
    try {
        window_.save_picture(path_, true);
    } catch (const std::exception& e) {
        const app::Failure failure = app::failure_of(e);
        status_ = app::fail(failure.text, failure.status);
    }
    window_.close();
}

}  // namespace palpate::viewer
