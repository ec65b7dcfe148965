// The position of a hand over time, from rows of positions. Header only: the recorded device plays
// such a path, the simulated hand follows one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::devices {

/// Straight lines between positions at strictly increasing times. At least one position; it rests
/// at the ends.
class TimedPath {
  public:
    struct Place {
        Vec3 position = Vec3::Zero();
        Vec3 velocity = Vec3::Zero();  ///< of the line that is being travelled
        std::size_t row = 0;           ///< the last one at or before the time
    };

    TimedPath(std::vector<double> time, std::vector<Vec3> position)
        : time_(std::move(time)), position_(std::move(position)) {}

    double begin() const noexcept { return time_.front(); }
    double end() const noexcept { return time_.back(); }

    /// At the time of a row: that row's position, bit for bit. Not const: it remembers the row, for
    /// times come in order and a search in a long path takes many times as long as the rest.
    Place at(double time) noexcept {
        if (!(time > begin())) return {position_.front(), Vec3::Zero(), 0};
        if (time >= end()) return {position_.back(), Vec3::Zero(), time_.size() - 1};
        if (!(time_[row_] <= time)) row_ = row_at(time);
        if (time >= time_[row_ + 1]) row_ = time < time_[row_ + 2] ? row_ + 1 : row_at(time);
        const Vec3 way = position_[row_ + 1] - position_[row_];
        const double takes = time_[row_ + 1] - time_[row_];
        const double since = time - time_[row_];
        if (since == 0) return {position_[row_], way / takes, row_};
        return {position_[row_] + way * (since / takes), way / takes, row_};
    }

  private:
    std::size_t row_at(double time) const noexcept {
        const auto after = std::upper_bound(time_.begin(), time_.end(), time);
        return static_cast<std::size_t>(after - time_.begin()) - 1;
    }

    std::vector<double> time_;  // [s]
    std::vector<Vec3> position_;
    std::size_t row_ = 0;  // never the last
};

/// A time that runs from 0 to `duration`, back to 0 and so on for ever: no jump anywhere.
/// `direction` is +1 on the way there, -1 on the way back.
struct ThereAndBack {
    double time = 0;
    double direction = 1;
};
inline ThereAndBack there_and_back(double time, double duration) noexcept {
    if (!(duration > 0)) return {};
    const double round = std::fmod(time, 2 * duration);
    if (round <= duration) return {round, 1};
    return {2 * duration - round, -1};
}

}  // namespace palpate::devices
