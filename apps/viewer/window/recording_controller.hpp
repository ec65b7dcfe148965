// Records the live run, all hands into one file, and plays recordings and sequences: the clock of a
// recording, and the timeline's connection with it or with the player.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>

#include <algorithm>
#include <cmath>
#include <memory>

#include "apps/viewer/window/desk.hpp"

namespace palpate::io {
class RecordingWriter;
}

namespace palpate::viewer {

class RecordingController : public Controller {
    Q_OBJECT

  public:
    explicit RecordingController(const Desk& desk);

    /// Errors are shown.
    void start(const QString& path);
    void stop();
    bool recording() const { return writer() != nullptr; }
    /// Ends a recording that cannot be written any more, which shows why.
    void check();
    /// 0, or the status for a program in which a recording was lost.
    int exit_status() const { return exit_status_; }

  Q_SIGNALS:
    void changed();

  private:
    const io::RecordingWriter* writer() const;
    void tell_playback();
    double seconds() const;

    int exit_status_ = 0;
    double began_ = 0;  // [s] of the run
};

/// Times are those of the recording [s], between begin and end.
class PlaybackClock {
  public:
    PlaybackClock() = default;
    PlaybackClock(double begin, double end) : begin_(begin), end_(end), time_(begin) {}

    double time() const { return time_; }
    double speed() const { return speed_; }
    bool loop() const { return loop_; }
    /// Seconds of the recording in a second; 0: pause. At the end it begins again.
    void play(double speed) {
        if (speed_ == 0 && speed != 0 && time_ >= end_) time_ = begin_;
        speed_ = speed;
    }
    /// Goes to a time; outside the recording, to its ends.
    void seek(double time) { time_ = std::clamp(std::isnan(time) ? begin_ : time, begin_, end_); }
    void set_loop(bool loop) { loop_ = loop; }
    /// `seconds` have passed. At the end it pauses, unless it loops.
    void advance(double seconds) {
        const double to = time_ + speed_ * seconds, length = end_ - begin_;
        if (to < end_ || speed_ == 0) {
            time_ = to;
        } else if (loop_ && length > 0) {
            time_ = begin_ + std::fmod(to - begin_, length);
        } else {
            time_ = end_;
            speed_ = 0;
        }
    }

  private:
    double begin_ = 0, end_ = 0, time_ = 0, speed_ = 0;
    bool loop_ = false;
};

struct Overview;
struct TimelineView;

class TimelineController : public Controller {
  public:
    explicit TimelineController(const Desk& desk);

    /// Goes to a time of the recording [s]; nothing without one.
    void show_time(double time);
    /// Lets the recording go on by the time that has passed. Before a snapshot is shown.
    void advance();
    /// Updates the timeline; reports missing frames.
    void observe();

  private:
    void connect_timeline();
    void show_hand();
    void show();
    TimelineView view() const;

    PlaybackClock clock_;
    QElapsedTimer since_;  // the last advance()
    std::shared_ptr<const Overview> overview_;
    QString problem_;
};

}  // namespace palpate::viewer
