// The timeline below the views: plays a sequence or a recording, seeks, sets speed and loop.
#pragma once

#include <QAbstractSlider>
#include <QIcon>
#include <QWidget>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/level_axis.hpp"
#include "apps/viewer/panel/timeline_view.hpp"

class QCheckBox;
class QLabel;
class QToolButton;

namespace palpate::viewer {

/// A click or drag chooses a time; arrows step to the frames beside it, Page Up and Down go by a
/// tenth of the whole, Home and End to the ends. As a slider its value counts milliseconds from the
/// begin.
class TimelineTrack : public QAbstractSlider {
    Q_OBJECT

  public:
    TimelineTrack();

    /// All but the time; emits nothing. True if times or frames are others than before.
    bool set_view(const TimelineView& view);
    const TimelineView& view() const { return view_; }
    /// [s], between begin and end.
    double time() const { return time_; }
    /// [s]; brought within begin and end. Emits nothing.
    void set_time(double time);

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  Q_SIGNALS:
    /// By the user [s].
    void chosen(double time);
    /// A frame forward (1) or back (-1).
    void stepped(int direction);

  protected:
    bool event(QEvent* event) override;
    void paintEvent(QPaintEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;

  private:
    QRectF plot() const;
    LevelAxis axis() const;
    void choose(double time);
    void paint_frames(QPainter& painter) const;
    void paint_overview(QPainter& painter) const;

    TimelineView view_;
    double time_ = 0;
};

/// Has no clock: it shows the views that it is given, and emits what the user asks for. Whoever
/// carries that out gives it a view at once. For a live source only the play button works.
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
    bool playing() const { return speed_now_ != 0; }
    /// The user is dragging in the track.
    bool dragging() const;

  Q_SIGNALS:
    /// Seconds of the sequence or recording in a second; 0: pause. Emitted by the play button, by
    /// the speed box while it plays, and by a step, which ends playing.
    void speed_asked(double speed);
    /// [s], between begin and end.
    void moment_asked(double time);
    void loop_asked(bool loop);

  private:
    void connect_inputs();
    void show_playing();
    void show_possible();

    QToolButton *back_, *play_, *forward_;
    TimelineTrack* track_;
    QLabel* text_;
    NumberBox* speed_;
    QCheckBox* loop_;
    double speed_now_ = 0;
    double play_speed_ = 1;  // while it plays; below 0: backwards
};

}  // namespace palpate::viewer
