// Watches one thread for locks, exceptions and system calls.
#pragma once

#include <cstdint>

namespace palpate::support {

/// Watches the calling thread from now on. System calls other than sleeping and reading clocks are
/// caught (seccomp), counted, and fail. If the kernel does not allow that, returns false and counts
/// only locks and exceptions. Not for sanitizers, which make system calls of their own.
bool watch_this_thread();
/// Ends the count of locks and exceptions; system calls stay watched.
void end_watch();

struct SystemCount {
    std::int64_t locks = 0;       ///< pthread_mutex_lock, condition variables included
    std::int64_t exceptions = 0;  ///< thrown, caught or not
    std::int64_t calls = 0;       ///< system calls that were caught
    long last_call = -1;          ///< number of the last of them
};
SystemCount system_count();

}  // namespace palpate::support
