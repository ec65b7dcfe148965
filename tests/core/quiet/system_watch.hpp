// Watches what one thread asks of the system: locks, exceptions, and system calls of any kind.
#pragma once

#include <cstdint>

namespace palpate::support {

/// From here on the calling thread is watched. System calls other than sleeping and reading clocks
/// are caught (seccomp), counted, and fail; where the kernel does not allow that, returns false and
/// only locks and exceptions are counted. Not for sanitizers, which have system calls of their own.
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
