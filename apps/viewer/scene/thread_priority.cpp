// Sets the niceness of a thread; Linux keeps it by thread.
#include "apps/viewer/scene/thread_priority.hpp"

#include <sys/resource.h>

namespace palpate::viewer {

void lower_thread_priority() noexcept {
    constexpr int niceness = 10;
    (void)::setpriority(PRIO_PROCESS, 0, niceness);
}

}  // namespace palpate::viewer
