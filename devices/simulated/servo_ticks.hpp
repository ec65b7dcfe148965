// The uneven servo of a simulated device. Its vendor's tool measured the servo of a Touch in
// several runs: means of 977 to 1012 Hz, standard deviations of 21 to 41 Hz, extremes of 414 and
// 1237 Hz.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "scenes/random.hpp"

namespace palpate::devices {

/// The ticks follow each other at a rate that is drawn for each: about 1000 Hz, with the smallest
/// of those deviations. One tick in 330 is late, at the lowest of those rates, and the next one
/// follows at the highest. Together their deviation is then about 41 Hz, the largest of those.
class ServoTicks {
  public:
    static constexpr double usual = 1000, slowest = 414, fastest = 1237;  ///< [Hz]

    explicit ServoTicks(std::uint64_t seed) noexcept : random_(seed) {}

    /// [s] from one tick to the next.
    double next() noexcept {
        if (std::exchange(was_late_, false)) return 1 / fastest;
        was_late_ = random_.uniform() < 1.0 / 330;
        if (was_late_) return 1 / slowest;
        double sum = 0;  // of twelve: almost normal, with a standard deviation of 1
        for (int i = 0; i < 12; ++i) sum += random_.uniform(-0.5, 0.5);
        return 1 / std::clamp(usual + 21 * sum, slowest, fastest);
    }

  private:
    scenes::Random random_;
    bool was_late_ = false;
};

}  // namespace palpate::devices
