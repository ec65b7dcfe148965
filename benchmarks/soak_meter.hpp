// Measurements of palpate_soak for each interval, in addition to the servo's own report.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <vector>

#include "palpate/device.hpp"
#include "palpate/exchange.hpp"

namespace palpate::benchmarks {

inline std::int64_t now_ns(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

/// Stands between the servo and its device, and measures for each interval what the servo's report
/// has for the whole run only. A measure of its own, too: all CPU time of the servo's thread from
/// one reading of the device to the next, falling asleep and waking included.
class Meter final : public Device {
  public:
    struct Interval {
        LatencyHistogram lateness, cpu;  ///< [ns]
    };

    /// Rate [Hz], length of an interval and of the run [s].
    Meter(Device& device, double rate, double every, double seconds)
        : device_(device),
          period_(std::floor(1e9 / rate)),  // whole ns, as the servo's
          every_(every),
          // A run takes longer than asked for, by a stall at its end at most.
          intervals_(static_cast<std::size_t>(seconds / every) + 2) {}

    const Interval& interval(std::size_t i) const { return intervals_[i]; }

    DeviceInfo info() const override { return device_.info(); }
    DeviceReading read(double time) noexcept override {
        const auto number = static_cast<std::size_t>(std::max(0.0, time) / every_);
        Interval& now = intervals_[std::min(number, intervals_.size() - 1)];
        const std::int64_t cpu = now_ns(CLOCK_THREAD_CPUTIME_ID);
        if (last_cpu_ >= 0) now.cpu.add(cpu - last_cpu_);
        last_cpu_ = cpu;
        start_ = now_ns(CLOCK_MONOTONIC);
        double late = 1e9 * time - due_;
        // The servo looks at its clock a microsecond later than this does and may have counted
        // another tick as missed: then all after it seem late by a period, or, where two stalls in
        // a row were taken for that, early.
        if (late < -0.5 * period_ || (late >= period_ && behind_)) {
            due_ += period_ * std::floor(late / period_);
            late = 1e9 * time - due_;
        }
        behind_ = late >= period_;
        now.lateness.add(static_cast<std::int64_t>(late));
        return device_.read(time);
    }
    void write(const Wrench& wrench, double time) noexcept override {
        device_.write(wrench, time);
        // Ticks have their places on a grid from time 0 on; those that were slept through are not
        // made up.
        const double end = 1e9 * time + static_cast<double>(now_ns(CLOCK_MONOTONIC) - start_);
        due_ += period_ * std::max(1.0, std::floor((end - due_) / period_));
    }
    void stop() noexcept override { device_.stop(); }

  private:
    Device& device_;
    const double period_;  // [ns]
    const double every_;   // [s]
    std::vector<Interval> intervals_;
    std::int64_t last_cpu_ = -1, start_ = 0;
    double due_ = 0;  // [ns]
    bool behind_ = false;
};

}  // namespace palpate::benchmarks
