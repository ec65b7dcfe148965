// Lowers the priority of background threads.
#pragma once

#include <sys/resource.h>

namespace palpate::viewer {

/// Lowers the priority of the calling thread and of those that it starts below the servo's and the
/// window's: Linux keeps the niceness by thread. Does nothing where the system does not support it.
inline void lower_thread_priority() noexcept {
    constexpr int niceness = 10;
    (void)::setpriority(PRIO_PROCESS, 0, niceness);
}

}  // namespace palpate::viewer
