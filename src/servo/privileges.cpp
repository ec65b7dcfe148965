// SCHED_FIFO, mlockall and timer slack. POSIX and Linux.
#include "servo/privileges.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>

namespace palpate {
namespace {

std::string ask_for_priority(int priority) {
    const int error = take_priority(priority);
    if (error == 0) return "real-time priority: SCHED_FIFO " + std::to_string(priority);
    return std::string("real-time priority: not granted (") + std::strerror(error) +
           "); allow it with a line '@audio - rtprio 90' in /etc/security/limits.d and your user "
           "in "
           "that group";
}

std::string ask_for_memory() {
    // Later allocations are not locked: the servo needs none of them, and with a limit on locked
    // memory every later allocation of the program would fail.
    if (mlockall(MCL_CURRENT) == 0) return "memory: locked";
    const int error = errno;
    return std::string("memory: not locked (") + std::strerror(error) +
           "); allow it with a line '@audio - memlock unlimited' in /etc/security/limits.d";
}

}  // namespace

int take_priority(int priority) noexcept {
    // 1 ns for threads without SCHED_FIFO: by default they may be woken 50 us late to save power.
    prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
    sched_param parameter{};
    parameter.sched_priority = priority;
    return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
}

std::vector<std::string> ask_for_real_time(int priority) {
    touch_stack();
    return {ask_for_priority(priority), ask_for_memory()};
}

}  // namespace palpate
