// Linux keeps niceness by thread.
#include "apps/viewer/scene/patience.hpp"

#include <sys/resource.h>

namespace palpate::viewer {

void stand_back() noexcept {
    constexpr int niceness = 10;
    (void)::setpriority(PRIO_PROCESS, 0, niceness);
}

}  // namespace palpate::viewer
