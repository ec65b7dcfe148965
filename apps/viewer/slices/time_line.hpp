// Plays a recording: a button, the time with the force's course, how fast, and again.
#pragma once

#include <QElapsedTimer>
#include <QIcon>
#include <QTimer>
#include <QWidget>

#include "apps/viewer/model/playback.hpp"

class QCheckBox;
class QComboBox;
class QLabel;
class QToolButton;

namespace palpate::viewer {

class TimeTrack;

/// The clock of a playback. Times are the recording's own [s], from begin() to end(). Hiding it
/// pauses.
class TimeLine : public QWidget {
    Q_OBJECT

  public:
    explicit TimeLine(QWidget* parent = nullptr);

    /// Another recording, or the same anew: paused, at its begin. Tells nobody.
    void set_playback(const Playback& playback) { set_overview(playback.overview()); }
    void set_overview(const Overview& overview);
    void clear();

    double time() const;
    /// Outside the recording: its ends. Tells nobody; goes on from there while it plays.
    void set_time(double time);
    bool playing() const { return timer_.isActive(); }
    /// At the end it begins again. Nothing without a recording.
    void set_playing(bool playing);
    /// Of the recorded time: 0.1, 0.25, 0.5, 1, 2 or 4; another one becomes the nearest.
    double speed() const;
    void set_speed(double speed);
    /// Whether it begins again after the end.
    bool loops() const;
    void set_loop(bool loop);

  Q_SIGNALS:
    /// By the person or by playing.
    void time_chosen(double time);
    void playing_changed(bool playing);

  protected:
    void hideEvent(QHideEvent* event) override;
    void changeEvent(QEvent* event) override;

  private:
    void build();
    void advance();
    void show_time();
    void show_state();
    QIcon icon(bool pause) const;

    Overview overview_;
    QToolButton* button_;
    TimeTrack* track_;
    QLabel* label_;
    QComboBox* speed_;
    QCheckBox* loop_;
    QTimer timer_;
    QElapsedTimer since_;  // the last advance
};

}  // namespace palpate::viewer
