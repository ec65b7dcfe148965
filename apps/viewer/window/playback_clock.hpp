// The clock of a recording that is played: its time, its speed, whether it loops.
#pragma once

#include <algorithm>
#include <cmath>

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

}  // namespace palpate::viewer
