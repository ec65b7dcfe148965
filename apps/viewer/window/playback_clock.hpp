// The clock of a recording that is played: where it is, how fast it goes, whether it loops.
#pragma once

namespace palpate::viewer {

/// Times are those of the recording [s], between begin and end.
class PlaybackClock {
  public:
    PlaybackClock() = default;
    PlaybackClock(double begin, double end) : begin_(begin), end_(end), time_(begin) {}

    double time() const { return time_; }
    double speed() const { return speed_; }
    bool loop() const { return loop_; }
    /// Seconds of the recording in a second; 0: pause. At the end it begins again.
    void play(double speed);
    /// Goes to a time; outside the recording, to its ends.
    void seek(double time);
    void set_loop(bool loop) { loop_ = loop; }
    /// `seconds` have passed. At the end it pauses, unless it loops.
    void advance(double seconds);

  private:
    double begin_ = 0, end_ = 0, time_ = 0, speed_ = 0;
    bool loop_ = false;
};

}  // namespace palpate::viewer
