// The system's clocks and threads; see the header. Linux.
#include "servo/clocks.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <ctime>
#include <string_view>

namespace palpate {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

std::int64_t now_ns(clockid_t clock) noexcept {
    timespec t{};
    ::clock_gettime(clock, &t);
    return t.tv_sec * second_ns + t.tv_nsec;
}

}  // namespace

std::int64_t monotonic_ns() noexcept {
    return now_ns(CLOCK_MONOTONIC);
}

std::int64_t thread_cpu_ns() noexcept {
    return now_ns(CLOCK_THREAD_CPUTIME_ID);
}

Alarm::Alarm() noexcept = default;
Alarm::~Alarm() = default;

void Alarm::sleep_until(std::int64_t ns) noexcept {
    const timespec t{static_cast<std::time_t>(ns / second_ns), static_cast<long>(ns % second_ns)};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
    }
}

ThreadId calling_thread() noexcept {
    clockid_t clock{};
    ::pthread_getcpuclockid(::pthread_self(), &clock);
    return {::gettid(), clock};
}

std::int64_t cpu_ns(ThreadId thread) noexcept {
    return now_ns(thread.clock);
}

bool is_runnable(ThreadId thread) noexcept {
    std::array<char, 64> path{};
    std::snprintf(path.data(), path.size(), "/proc/self/task/%d/stat", thread.number);
    const int file = ::open(path.data(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    std::array<char, 128> text{};
    const ssize_t size = ::read(file, text.data(), text.size());
    ::close(file);
    const std::string_view told(text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, size)));
    const std::size_t name_end = told.rfind(')');
    return name_end != std::string_view::npos && told.substr(name_end).starts_with(") R");
}

}  // namespace palpate
