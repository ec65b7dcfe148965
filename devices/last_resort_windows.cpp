// Stops the device when the program crashes or is ended. See last_resort.hpp. Windows. A filter can
// reach globals only: these are the writable globals of the devices.
#include <windows.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <mutex>
#include <stdexcept>

#include "devices/link.hpp"
#include "palpate/devices/last_resort.hpp"

namespace palpate::devices {
namespace {

std::array<std::atomic<Device*>, LastResort::most> guarded{};
/// Devices that were told to stop.
std::array<std::atomic<Device*>, LastResort::most> told{};

/// How long is waited for the zero [ms]: at least, for devices that cannot tell, and at most.
constexpr int least_wait = 100;
constexpr int most_wait = 1000;
/// Stack that is kept for the filter when that of a thread runs out [bytes].
constexpr ULONG filter_stack = 64 * 1024;

void sleep_in_handler(int milliseconds) noexcept {
    ::Sleep(static_cast<DWORD>(milliseconds));
}
std::atomic<LastResort::Pause> pause_in_handler{&sleep_in_handler};

bool is_stopping(const std::atomic<Device*>& place) {
    const Device* const device = place.load();
    return device && device->is_stopping();
}

void stop_all() {
    bool wait = false;  // also for what another thread has told to stop
    for (std::size_t i = 0; i < guarded.size(); ++i) {
        if (Device* const device = guarded[i].load()) told[i].store(device);
        if (Device* const device = guarded[i].exchange(nullptr)) device->stop();
        wait = wait || told[i].load();
    }
    constexpr int step = 5;
    for (int waited = 0; wait && waited < most_wait; waited += step) {
        if (waited >= least_wait && std::ranges::none_of(told, is_stopping)) return;
        pause_in_handler.load()(step);
    }
}

struct Before {
    LPTOP_LEVEL_EXCEPTION_FILTER filter = nullptr;
    void (*abort)(int) = SIG_DFL;
};
std::mutex changes;
Before before;

/// Every unhandled exception: access violations, divisions by zero, stacks that run out,
/// those that a program raises itself.
LONG WINAPI on_exception(EXCEPTION_POINTERS* exception) {
    stop_all();
    return before.filter ? before.filter(exception) : EXCEPTION_CONTINUE_SEARCH;
}

/// abort(), and with it an uncaught C++ exception.
void on_abort(int number) {
    stop_all();
    std::signal(number, before.abort);
    std::raise(number);
}

/// Ctrl-C, Ctrl-Break, the console closed, log-off, shutdown; on a thread of the system's. Those
/// that an application handles stay its own.
BOOL WINAPI on_end(DWORD) {
    stop_all();
    return FALSE;
}

void handle_ends() {
    before.filter = ::SetUnhandledExceptionFilter(&on_exception);
    before.abort = std::signal(SIGABRT, &on_abort);
    ::SetConsoleCtrlHandler(&on_end, TRUE);
}

void forget_ends() {
    // Put back only what is still ours.
    const LPTOP_LEVEL_EXCEPTION_FILTER now = ::SetUnhandledExceptionFilter(before.filter);
    if (now != &on_exception) ::SetUnhandledExceptionFilter(now);
    void (*const abort_now)(int) = std::signal(SIGABRT, before.abort);
    if (abort_now != &on_abort) std::signal(SIGABRT, abort_now);
    ::SetConsoleCtrlHandler(&on_end, FALSE);
}

bool none_guarded() {
    return std::ranges::none_of(guarded, [](const auto& place) { return place.load(); });
}

}  // namespace

LastResort::LastResort(Device& device, Pause pause) {
    const std::lock_guard lock(changes);
    if (std::ranges::any_of(guarded, [&](const auto& place) { return place.load() == &device; })) {
        throw std::logic_error("this device has a last resort already");
    }
    const bool first = none_guarded();
    const auto free_place =
        std::ranges::find_if(guarded, [](const auto& place) { return !place.load(); });
    if (free_place == guarded.end()) {
        throw std::logic_error("too many devices are guarded against crashes at once");
    }
    pause_in_handler.store(pause ? pause : &sleep_in_handler);
    free_place->store(&device);
    place_ = static_cast<std::size_t>(free_place - guarded.begin());
    ULONG stack = filter_stack;
    ::SetThreadStackGuarantee(&stack);
    if (first) handle_ends();
}

LastResort::~LastResort() {
    const std::lock_guard lock(changes);
    guarded[place_].store(nullptr);
    told[place_].store(nullptr);
    if (none_guarded()) forget_ends();
}

}  // namespace palpate::devices
