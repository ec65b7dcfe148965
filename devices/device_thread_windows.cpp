// Requests to the system of a thread that talks to a device. See link.hpp. Windows.
#include <windows.h>

#include <avrt.h>
#include <timeapi.h>

#include "devices/link.hpp"

namespace palpate::devices {
namespace {

/// CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, since Windows 10 1803; older headers lack it.
constexpr DWORD high_resolution = 2;
constexpr std::int64_t timer_unit_ns = 100;
constexpr UINT timer_period = 1;  // [ms] of the system's other timers

/// A thread's timer, and its stay in the multimedia scheduler's care.
class Privileges {
  public:
    void take() noexcept {
        ::timeBeginPeriod(timer_period);
        timer_ = ::CreateWaitableTimerExW(nullptr, nullptr, high_resolution, TIMER_ALL_ACCESS);
        if (!timer_) timer_ = ::CreateWaitableTimerExW(nullptr, nullptr, 0, TIMER_ALL_ACCESS);
        DWORD number = 0;
        task_ = ::AvSetMmThreadCharacteristicsW(L"Pro Audio", &number);
        if (task_) ::AvSetMmThreadPriority(task_, AVRT_PRIORITY_CRITICAL);
        if (!task_) ::SetThreadPriority(::GetCurrentThread(), THREAD_PRIORITY_TIME_CRITICAL);
        taken_ = true;
    }
    ~Privileges() {
        if (task_) ::AvRevertMmThreadCharacteristics(task_);
        if (timer_) ::CloseHandle(timer_);
        if (taken_) ::timeEndPeriod(timer_period);
    }
    HANDLE timer() const { return timer_; }
    bool taken() const { return taken_; }

  private:
    HANDLE timer_ = nullptr, task_ = nullptr;
    bool taken_ = false;
};

thread_local Privileges privileges;

}  // namespace

void sleep_until(std::int64_t ns) noexcept {
    const std::int64_t left = ns - monotonic_ns();
    if (left <= 0) return;
    LARGE_INTEGER due{};
    due.QuadPart = -((left + timer_unit_ns - 1) / timer_unit_ns);  // below 0: from now on
    const HANDLE timer = privileges.timer();
    if (timer && ::SetWaitableTimer(timer, &due, 0, nullptr, nullptr, FALSE)) {
        ::WaitForSingleObject(timer, INFINITE);
    } else {
        ::Sleep(static_cast<DWORD>((left + 999'999) / 1'000'000));
    }
}

bool is_device_thread() noexcept {
    return privileges.taken();
}

void prepare_device_thread() noexcept {
    privileges.take();
}

}  // namespace palpate::devices
