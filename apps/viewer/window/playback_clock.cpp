// Advances the time of a recording that is played.
#include "apps/viewer/window/playback_clock.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::viewer {

void PlaybackClock::play(double speed) {
    if (speed_ == 0 && speed != 0 && time_ >= end_) time_ = begin_;
    speed_ = speed;
}

void PlaybackClock::seek(double time) {
    time_ = std::clamp(std::isnan(time) ? begin_ : time, begin_, end_);
}

void PlaybackClock::advance(double seconds) {
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

}  // namespace palpate::viewer
