// Asks the operating system for real-time privileges and reports what it granted.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

/// Asks, for the calling thread, for exact timers and for SCHED_FIFO; 0 if that was granted,
/// otherwise the error number. The devices' threads use it, too.
int take_priority(int priority) noexcept;

/// The same, and for memory that stays in place. A sentence for each: what was granted, or what was
/// not and what to set.
std::vector<std::string> ask_for_real_time(int priority);

/// Touches the stack as deep as a tick may reach, so that no page of it faults later.
inline void touch_stack() {
    std::array<volatile char, std::size_t{128} * 1024> deep;
    for (std::size_t i = 0; i < deep.size(); i += 1024) deep[i] = 0;
}

}  // namespace palpate
