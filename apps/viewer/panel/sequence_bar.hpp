// Plays a sequence of volumes: a button, frame by frame, the time, how fast, and again.
#pragma once

#include <QIcon>
#include <QWidget>

#include "apps/viewer/panel/pacer.hpp"
#include "apps/viewer/panel/sequence_view.hpp"

class QCheckBox;
class QLabel;
class QToolButton;

namespace palpate::viewer {

class NumberBox;
class SequenceTrack;

/// Has no clock: it shows what it is told, and asks. What was asked for is shown at once; views
/// that were taken before it was obeyed are passed over, three of them at most. For a live source
/// only the play button can be used. Object names: sequence_bar, sequence_back, sequence_play,
/// sequence_forward, sequence_track, sequence_time, sequence_speed, sequence_loop.
class SequenceBar : public QWidget {
    Q_OBJECT

  public:
    explicit SequenceBar(QWidget* parent = nullptr);

    /// Thirty times a second: what is as before costs a comparison. Emits nothing, and leaves a
    /// drag alone.
    void set_view(const SequenceView& view);
    /// As if the button was pressed.
    void toggle_playing();
    /// As if a step button was pressed: a frame on (1) or back (-1).
    void step(int way);

  Q_SIGNALS:
    /// Seconds of the sequence in a second; 0: stand still. Asked for by the play button, by the
    /// box while it plays, and by a step, which ends playing.
    void speed_asked(double speed);
    /// [s], between begin and end; at most 60 a second in a drag, whose last always comes.
    void moment_asked(double time);
    void loop_asked(bool loop);

  protected:
    void changeEvent(QEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;

  private:
    enum class Shape { play, pause, back, forward };

    void build();
    void connect_inputs();
    void show_speed(double speed);
    void show_loop(bool loop);
    void show_time(double time);
    void show_text();
    void show_playing(bool playing);
    void show_icons();
    void show_possible();
    void ask_speed(double speed);
    void ask_moment(double time);
    QIcon icon(Shape shape) const;

    QToolButton *back_, *play_, *forward_;
    SequenceTrack* track_;
    QLabel* text_;
    NumberBox* speed_;
    QCheckBox* loop_;
    Pacer pacer_;
    bool playing_ = false;
    double play_speed_ = 1;  // while it plays; below 0: backwards
    double asked_time_ = 0;
    int speed_grace_ = 0, time_grace_ = 0, loop_grace_ = 0;  // views that may still disagree
};

}  // namespace palpate::viewer
