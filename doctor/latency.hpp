// Measures how punctually this machine runs a servo, by running one.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "palpate/servo.hpp"

namespace palpate::doctor {

/// Ticks that were woken no later than this, and later than the bin before.
struct LatenessBin {
    double to_us = 0;
    std::uint64_t ticks = 0;
};

/// What was measured: a servo thread at 1000 Hz that renders a surface under a simulated hand.
struct Latency {
    double seconds = 0;
    bool under_load = false;  ///< as many other threads as there are processors compute meanwhile
    ServoReport report;
    std::vector<LatenessBin> histogram;  ///< all ticks, once each; the last bin ends at the maximum
    std::vector<std::string> privileges;  ///< a sentence each, as Servo::privileges()
    std::string rendered;                 ///< what was felt, for a report
};

struct LatencySettings {
    double seconds = 10;
    bool under_load = false;
    /// Called about ten times a second with the part done, 0 to 1; may throw to stop.
    std::function<void(double)> progress = [](double) {};
};

/// Runs the servo for that long. Throws std::system_error if the system gives no thread.
Latency measure_latency(const LatencySettings& settings);

}  // namespace palpate::doctor
