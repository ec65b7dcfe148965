// Durations and force flags in words.
#include "apps/options/words.hpp"

#include <fmt/format.h>

namespace palpate::app {

std::string duration_text(std::int64_t ns) {
    if (ns < 1000) return fmt::format("{} ns", ns);
    const double us = 1e-3 * static_cast<double>(ns);
    if (us < 1000) return fmt::format("{:.3g} us", us);
    if (us < 1e6) return fmt::format("{:.3g} ms", 1e-3 * us);
    return fmt::format("{:.3g} s", 1e-6 * us);
}

std::string counted(std::uint64_t count, const std::string& thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

std::string force_words(const Tick& tick) {
    const unsigned flags = tick.force_flags;
    if (flags & force_off) return "off";
    if (tick.proxy.status == UpdateStatus::recovering) return "recovering";
    if (tick.proxy.status == UpdateStatus::not_finite) return "not finite";
    if (tick.proxy.status == UpdateStatus::waiting) return "waiting for data";
    if (flags & (force_stale | force_not_finite)) return "no input";
    if (flags & force_overrun) return "too late";
    if (flags & force_waiting) return "waiting";
    if (flags & force_ramping) return "ramp";
    if (flags & force_warm) return "motors warm";
    if (flags & force_limited) return "limit";
    if (flags & force_rate_limited) return "rate limit";
    return {};
}

}  // namespace palpate::app
