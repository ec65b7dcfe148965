// Asks the operating system for real-time privileges and reports what it granted.
#pragma once

#include <string>
#include <vector>

namespace palpate {

/// Asks, for the calling thread, for SCHED_FIFO, for memory that stays in place and for exact
/// timers. A sentence for each: what was granted, or what was not and what to set.
std::vector<std::string> ask_for_real_time(int priority);

/// Asks, for the calling thread, for SCHED_FIFO; 0 if it was granted, otherwise the error number.
int take_priority(int priority) noexcept;

}  // namespace palpate
