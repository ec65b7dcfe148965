// Passes requests of the timeline to the player or the clock, and their state to the timeline.
#include "apps/viewer/window/timeline_controller.hpp"

#include <utility>

#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {
TimelineController::TimelineController(Content& content, Timeline& timeline, Messages& messages)
    : content_(content), timeline_(timeline), messages_(messages) {
    connect_timeline();
    connect(&content, &Content::closed, &timeline, &QWidget::hide);
    connect(&content, &Content::run_changed, this, &TimelineController::show);
    connect(&content, &Content::playback_started, this, [this] {
        clock_ = {};
        show_hand();
    });
    connect(&content, &Content::hand_changed, this, [this] {
        if (content_.playback()) show_hand();
    });
    timeline.hide();
    since_.start();
}

void TimelineController::connect_timeline() {
    // Both can play, seek and loop.
    const auto ask = [this](auto&& action) {
        if (run::Player* player = content_.player()) {
            messages_.guarded([&] { action(*player); });
        } else if (content_.playback()) {
            action(clock_);
            content_.set_time(clock_.time());
        }
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
    TimelineView view;
    if (const Playback* playback = content_.playback()) {
        view.begin = playback->begin();
        view.end = playback->end();
        view.time = clock_.time();
        view.speed = clock_.speed();
        view.loop = clock_.loop();
        view.overview = overview_;
    }
    return view;
}

/// The times are those of the chosen hand; the clock goes on.
void TimelineController::show_hand() {
    const Playback& playback = *content_.playback();
    PlaybackClock clock(playback.begin(), playback.end());
    clock.set_loop(clock_.loop());
    clock.play(clock_.speed());
    clock.seek(content_.time());
    clock_ = clock;
    overview_ = std::make_shared<Overview>(playback.overview());
    show();
}

void TimelineController::show() {
    timeline_.setVisible(content_.player() || content_.playback());
    if (!timeline_.isHidden()) timeline_.set_view(view());
}

void TimelineController::show_time(double time) {
    if (!content_.playback()) return;
    clock_.seek(time);
    content_.set_time(clock_.time());
    timeline_.set_view(view());
}

void TimelineController::advance() {
    const double passed = 1e-9 * static_cast<double>(since_.nsecsElapsed());
    since_.restart();
    if (!content_.playback() || timeline_.dragging()) return;
    clock_.advance(passed);
    content_.set_time(clock_.time());
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
