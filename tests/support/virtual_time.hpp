// Time for tests of paced components: it passes at once when the test says so.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace palpate::support {

/// [ns] Of all threads of the program. Begins late, as the machine's clock does.
inline std::atomic<std::int64_t> virtual_time{1'000'000'000'000};

/// For whatever takes a Clock.
inline std::int64_t virtual_now() noexcept {
    return virtual_time.load();
}
inline void pass(std::chrono::nanoseconds time) noexcept {
    virtual_time.fetch_add(time.count());
}
/// Sleeping takes no longer than this. A time that is past changes nothing.
inline void pass_until(std::int64_t ns) noexcept {
    if (ns > virtual_now()) virtual_time.store(ns);
}
/// Since an earlier virtual_now().
inline std::chrono::nanoseconds passed_since(std::int64_t before) noexcept {
    return std::chrono::nanoseconds(virtual_now() - before);
}

}  // namespace palpate::support
