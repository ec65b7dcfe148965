// Records the live run, all hands into one file, and connects the timeline with the recording or
// the sequence that is played.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>

#include "apps/viewer/model/run_closer.hpp"
#include "apps/viewer/panel/timeline.hpp"
#include "apps/viewer/window/desk.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::io {
class RecordingWriter;
}

namespace palpate::viewer {

class Timeline;

class RecordingController : public Controller {
    Q_OBJECT

  public:
    explicit RecordingController(const Desk& desk);

    /// In the background, until there is a checksum of the volume and a pipe has a reader. Errors
    /// are shown.
    void start(const QString& path);
    /// At once. What is left is written in the background, for as long as the reader of a pipe
    /// takes or until it is cancelled.
    void stop();
    bool settled() const { return !preparing_.busy() && !ending_.busy(); }
    /// The program ends: a reader has half a second for a recording that was stopped.
    void finish();
    bool recording() const { return writer() != nullptr; }
    /// Ends a recording that cannot be written any more, which shows why, and tells of one that has
    /// ended otherwise; twice a second.
    void check();
    /// 0, or the status for a program in which a recording was lost.
    int exit_status() const { return exit_status_; }

  Q_SIGNALS:
    void changed();

  private:
    const io::RecordingWriter* writer() const;
    void begin(const QString& path);
    void tell_playback();
    void tell_end();
    void tell_recorded(double seconds);
    void tell_runs_ended(const RunCloser::Ended& how);
    double seconds() const;

    BackgroundTask preparing_, ending_;
    bool records_ = false;  // as far as the person knows
    int exit_status_ = 0;
    double began_ = 0;     // [s] of the run
    double recorded_ = 0;  // [s] in the recording that ends with its run
};

class TimelineController : public Controller {
  public:
    TimelineController(const Desk& desk, Timeline& timeline);

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

    Timeline& timeline_;
    TimelineView recorded_;  // of the chosen hand
    QElapsedTimer since_;    // the last advance()
    QString problem_;
};

}  // namespace palpate::viewer
