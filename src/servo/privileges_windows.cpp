// Priority by the Multimedia Class Scheduler, and locked pages. Windows.
#include <windows.h>

#include <avrt.h>

#include <algorithm>
#include <vector>

#include "servo/privileges.hpp"

namespace palpate {
namespace {

std::string ask_for_priority(int priority) {
    const int error = take_priority(priority);
    if (error == 0) return "real-time priority: Pro Audio of the Multimedia Class Scheduler";
    const std::string no =
        "real-time priority: Pro Audio was not granted (error " + std::to_string(error) + ")";
    if (::GetThreadPriority(::GetCurrentThread()) == THREAD_PRIORITY_TIME_CRITICAL) {
        return no + ", but time critical; start the service 'Multimedia Class Scheduler'";
    }
    return no + ", nor time critical; start the program with a higher priority class";
}

struct Region {
    void* begin;
    SIZE_T bytes;
};

/// All private memory that the program has now and writes to.
std::vector<Region> private_memory() {
    std::vector<Region> regions;
    MEMORY_BASIC_INFORMATION about{};
    const char* at = nullptr;
    while (::VirtualQuery(at, &about, sizeof about) == sizeof about) {
        const bool writable = about.Protect == PAGE_READWRITE;
        if (about.State == MEM_COMMIT && about.Type == MEM_PRIVATE && writable) {
            regions.push_back({about.BaseAddress, about.RegionSize});
        }
        at = static_cast<const char*>(about.BaseAddress) + about.RegionSize;
    }
    return regions;
}

/// Pages can be locked only within the working set that the system promises the process.
bool enlarge_working_set(SIZE_T locked) {
    constexpr SIZE_T unlocked = 32 << 20;  // for all else: code, pages that come later
    SIZE_T least = 0, most = 0;
    const HANDLE process = ::GetCurrentProcess();
    if (!::GetProcessWorkingSetSize(process, &least, &most)) return false;
    if (least >= locked + unlocked) return true;  // by an earlier servo
    return ::SetProcessWorkingSetSize(process, locked + unlocked,
                                      std::max(most, locked + 2 * unlocked)) != 0;
}

/// A thread's stay in the multimedia scheduler's care.
class Task {
  public:
    Task() = default;
    ~Task() {
        if (handle_) ::AvRevertMmThreadCharacteristics(handle_);
    }
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

    /// 0, or the error number.
    DWORD begin() noexcept {
        DWORD number = 0;
        if (!handle_) handle_ = ::AvSetMmThreadCharacteristicsW(L"Pro Audio", &number);
        if (!handle_) return ::GetLastError();
        ::AvSetMmThreadPriority(handle_, AVRT_PRIORITY_CRITICAL);
        return 0;
    }

  private:
    HANDLE handle_ = nullptr;
};

thread_local Task task;

std::string ask_for_memory() {
    const std::vector<Region> regions = private_memory();
    SIZE_T wanted = 0, locked = 0;
    for (const Region& region : regions) wanted += region.bytes;
    DWORD error = enlarge_working_set(wanted) ? 0 : ::GetLastError();
    for (const Region& region : regions) {
        if (::VirtualLock(region.begin, region.bytes)) {
            locked += region.bytes;
        } else if (error == 0) {
            error = ::GetLastError();
        }
    }
    if (locked == wanted) return "memory: locked";
    constexpr SIZE_T megabyte = 1 << 20;
    return "memory: " + std::to_string(locked / megabyte) + " of " +
           std::to_string(wanted / megabyte) + " MB locked (error " + std::to_string(error) +
           "); allow it with the right 'Increase a process working set' in the local security "
           "policy, or close other programs";
}

}  // namespace

int take_priority(int) noexcept {
    const DWORD error = task.begin();
    if (error != 0) ::SetThreadPriority(::GetCurrentThread(), THREAD_PRIORITY_TIME_CRITICAL);
    return static_cast<int>(error);
}

std::vector<std::string> ask_for_real_time(int priority) {
    touch_stack();
    return {ask_for_priority(priority), ask_for_memory()};
}

}  // namespace palpate
