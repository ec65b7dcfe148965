// Faults of the measured latency.
#include <fmt/format.h>

#include "doctor/faults.hpp"

namespace palpate::doctor {
namespace {

constexpr double most_missed = 1e-3;       // of the ticks
constexpr std::int64_t late_ns = 250'000;  // a quarter of a period

/// The remedy for a machine that is late. Its other faults come first.
std::string way_to_punctuality(const Facts& facts) {
    const Machine& machine = facts.machine;
    if (facts.limits.priority_error != 0) return "fix real-time-priority first, and measure again";
    if (machine.is_virtual) {
        return "run it on a physical machine: a virtual one has to wait when its host is "
               "busy";
    }
    if (machine.preemption != Preemption::real_time) {
        return "fix the other faults first; then sudo apt install linux-image-rt-amd64, and "
               "reboot";
    }
    return "look for interruptions by the firmware: sudo apt install rt-tests; sudo hwlatdetect; "
           "switch power saving and USB legacy support off in the BIOS";
}

}  // namespace

std::vector<Fault> latency_faults(const Facts& facts) {
    if (!facts.latency) return {};
    const ServoReport& report = facts.latency->report;
    const auto ticks = static_cast<double>(report.ticks + report.missed);
    const double missed = ticks > 0 ? static_cast<double>(report.missed) / ticks : 1;
    const char* const when = facts.latency->under_load ? " under load" : "";
    if (missed > most_missed) {
        return {{"ticks-missed", true,
                 fmt::format("{} of {:.0f} ticks were missed{}: the force stutters", report.missed,
                             ticks, when),
                 way_to_punctuality(facts)}};
    }
    if (report.lateness.p999 > late_ns || report.missed > 0) {
        return {{"ticks-late", false,
                 fmt::format("one tick in a thousand is woken {:.0f} us late or later{}, at worst "
                             "{:.0f} us; {} were missed",
                             static_cast<double>(report.lateness.p999) / 1000, when,
                             static_cast<double>(report.lateness.max) / 1000, report.missed),
                 way_to_punctuality(facts)}};
    }
    return {};
}

}  // namespace palpate::doctor
