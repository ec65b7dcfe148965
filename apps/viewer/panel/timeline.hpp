// The timeline below the views: plays a sequence or a recording, seeks, sets speed and loop. Its
// views are plain values.
#pragma once

#include <QAbstractSlider>
#include <QIcon>
#include <QString>
#include <QWidget>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "apps/viewer/model/playback.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/level_axis.hpp"
#include "palpate/run/player.hpp"

class QCheckBox;
class QLabel;
class QToolButton;

namespace palpate::viewer {

/// What is played, and where. In a loop `time` may lie past the ends and wraps around, and the
/// stretch in memory may pass the end, or `loaded_to` lies below `loaded_from`; NaN: nothing is in
/// memory. A recording has no frames.
struct TimelineView : run::PlayState {
    TimelineView() { loop = false; }
    explicit TimelineView(run::PlayState play) : run::PlayState(std::move(play)) {}

    /// Of a recording, a player goes on by itself. Seconds of it in a second; 0: pause. At the end
    /// it begins again.
    void play(double to);
    /// Outside of the recording, to its ends.
    void seek(double to) { time = std::isnan(to) ? begin : std::clamp(to, begin, end); }
    void set_loop(bool on) { loop = on; }
    /// `seconds` have passed. At the end it pauses, unless it loops.
    void advance(double seconds);

    std::shared_ptr<const Overview> overview;  ///< of a recording; else null
};

bool empty(const TimelineView& view);
double length(const TimelineView& view);  ///< [s]
/// A time brought between begin and end: wrapped around in a loop, else the nearer end.
double within(const TimelineView& view, double time);
/// The last frame not after a time, from 0. Nothing without frames.
std::optional<std::size_t> frame_at(const TimelineView& view, double time);
/// The time of the next frame after (`direction` > 0) or before a time; wraps around in a loop. In
/// a recording 10 ms further. Nothing where there is none.
std::optional<double> frame_beside(const TimelineView& view, double time, int direction);
/// "1.60 s, frame 3 of 6"; in a recording "0:01.600 / 0:20.000" from its begin.
QString text_at(const TimelineView& view, double time);
/// What happened at a time of a recording: force, isovalue, contact.
QString overview_text_at(const TimelineView& view, double time);

/// What is in memory: one stretch, or two in a loop.
struct Stretch {
    double from, to;  ///< [s]
};
std::vector<Stretch> loaded_stretches(const TimelineView& view);

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
