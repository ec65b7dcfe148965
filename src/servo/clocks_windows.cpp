// The system's clocks and threads; see the header. Windows 10 and later.
#include <windows.h>

#include <timeapi.h>

#include <chrono>

#include "servo/clocks.hpp"

namespace palpate {
namespace {

/// CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, since Windows 10 1803; older headers lack it.
constexpr DWORD high_resolution = 2;
/// [ms] of the system's own timers while an Alarm exists: those of sleeps and older waits.
constexpr UINT timer_period = 1;
constexpr std::int64_t timer_unit_ns = 100;

}  // namespace

std::int64_t monotonic_ns() noexcept {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// The system counts a thread's CPU time in ticks of 15.6 ms.
std::int64_t thread_cpu_ns() noexcept {
    return monotonic_ns();
}

Alarm::Alarm() noexcept
    : timer_(::CreateWaitableTimerExW(nullptr, nullptr, high_resolution, TIMER_ALL_ACCESS)) {
    if (!timer_) timer_ = ::CreateWaitableTimerExW(nullptr, nullptr, 0, TIMER_ALL_ACCESS);
    ::timeBeginPeriod(timer_period);
}

Alarm::~Alarm() {
    ::timeEndPeriod(timer_period);
    if (timer_) ::CloseHandle(timer_);
}

void Alarm::sleep_until(std::int64_t ns) noexcept {
    const std::int64_t left = ns - monotonic_ns();
    if (left <= 0) return;
    LARGE_INTEGER due{};
    due.QuadPart = -((left + timer_unit_ns - 1) / timer_unit_ns);  // below 0: from now on
    if (timer_ && ::SetWaitableTimer(timer_, &due, 0, nullptr, nullptr, FALSE)) {
        ::WaitForSingleObject(timer_, INFINITE);
    } else {
        ::Sleep(static_cast<DWORD>((left + 999'999) / 1'000'000));
    }
}

ThreadId calling_thread() noexcept {
    return {static_cast<std::int32_t>(::GetCurrentThreadId()), 0};
}

std::int64_t cpu_ns(ThreadId) noexcept {
    return 0;
}

bool is_runnable(ThreadId) noexcept {
    return false;
}

}  // namespace palpate
