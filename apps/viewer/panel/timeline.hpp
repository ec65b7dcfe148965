// The timeline below the views: plays a sequence or a recording, seeks, sets speed and loop.
#pragma once

#include <QIcon>
#include <QWidget>

#include "apps/viewer/panel/awaited_change.hpp"
#include "apps/viewer/panel/rate_limiter.hpp"
#include "apps/viewer/panel/timeline_view.hpp"

class QCheckBox;
class QLabel;
class QToolButton;

namespace palpate::viewer {

class NumberBox;
class TimelineTrack;

/// Has no clock: it shows the views that it is given, and emits what the user asks for. That is
/// shown at once (AwaitedChange). For a live source only the play button works.
class Timeline : public QWidget {
    Q_OBJECT

  public:
    explicit Timeline(QWidget* parent = nullptr);

    /// Thirty times a second: an unchanged view costs a comparison. Emits nothing, and leaves a
    /// drag alone.
    void set_view(const TimelineView& view);
    /// As if the play button was pressed.
    void toggle_playing();
    /// As if a step button was pressed: a frame forward (1) or back (-1).
    void step(int direction);
    bool playing() const { return playing_; }
    /// The user is dragging in the track.
    bool dragging() const;

  Q_SIGNALS:
    /// Seconds of the sequence or recording in a second; 0: pause. Emitted by the play button, by
    /// the speed box while it plays, and by a step, which ends playing.
    void speed_asked(double speed);
    /// [s], between begin and end; at most 60 a second in a drag, and the last always.
    void moment_asked(double time);
    void loop_asked(bool loop);

  private:
    void connect_inputs();
    void show_speed(double speed);
    void show_time(double time);
    void show_text();
    void show_playing(bool playing);
    void show_possible();
    void ask_speed(double speed);
    void ask_moment(double time);

    QToolButton *back_, *play_, *forward_;
    TimelineTrack* track_;
    QLabel* text_;
    NumberBox* speed_;
    QCheckBox* loop_;
    RateLimiter limiter_;
    bool playing_ = false;
    double play_speed_ = 1;  // while it plays; below 0: backwards
    double asked_time_ = 0;
    AwaitedChange awaited_speed_, awaited_time_, awaited_loop_;
};

}  // namespace palpate::viewer
