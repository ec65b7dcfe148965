// Requests to the system of a thread that talks to a device. See link.hpp. Linux.
#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>

#include <cerrno>
#include <csignal>
#include <ctime>

#include "devices/link.hpp"

namespace palpate::devices {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

thread_local bool talks_to_a_device = false;

}  // namespace

void sleep_until(std::int64_t ns) noexcept {
    const timespec until{ns / second_ns, ns % second_ns};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

bool is_device_thread() noexcept {
    return talks_to_a_device;
}

void prepare_device_thread() noexcept {
    talks_to_a_device = true;
    ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
    sched_param parameter{};
    parameter.sched_priority = 81;
    ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameter);
    sigset_t others;
    ::sigfillset(&others);
    for (const int crash : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP, SIGSYS}) {
        ::sigdelset(&others, crash);
    }
    ::pthread_sigmask(SIG_BLOCK, &others, nullptr);
}

}  // namespace palpate::devices
