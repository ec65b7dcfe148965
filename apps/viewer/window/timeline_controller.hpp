// Connects the timeline with what it plays: the player of a sequence that is felt, or the clock of
// a recording.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <memory>

#include "apps/viewer/window/playback_clock.hpp"

namespace palpate::viewer {

class Content;
class Messages;
class Timeline;
struct Overview;
struct TimelineView;

class TimelineController : public QObject {
  public:
    TimelineController(Content& content, Timeline& timeline, Messages& messages);

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

    Content& content_;
    Timeline& timeline_;
    Messages& messages_;
    PlaybackClock clock_;
    QElapsedTimer since_;  // the last advance()
    std::shared_ptr<const Overview> overview_;
    QString problem_;
};

}  // namespace palpate::viewer
