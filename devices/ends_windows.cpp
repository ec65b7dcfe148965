// Handlers of exceptions, abort() and console events that stop the devices. Windows.
#include <windows.h>

#include <csignal>

#include "devices/ends.hpp"

namespace palpate::devices {
namespace {

/// Stack that is kept for the filter when that of a thread runs out [bytes].
constexpr ULONG filter_stack = 64 * 1024;

void stop_all() {
    if (stop_guarded()) wait_for_zeros();
}

struct Before {
    LPTOP_LEVEL_EXCEPTION_FILTER filter = nullptr;
    void (*abort)(int) = SIG_DFL;
};
Before before;
bool are_handled = false;

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

}  // namespace

void sleep_in_handler(int milliseconds) noexcept {
    ::Sleep(static_cast<DWORD>(milliseconds));
}

void handle_ends() {
    ULONG stack = filter_stack;
    ::SetThreadStackGuarantee(&stack);
    if (are_handled) return;
    are_handled = true;
    before.filter = ::SetUnhandledExceptionFilter(&on_exception);
    before.abort = std::signal(SIGABRT, &on_abort);
    ::SetConsoleCtrlHandler(&on_end, TRUE);
}

void forget_ends() {
    are_handled = false;
    // Put back only what is still ours.
    const LPTOP_LEVEL_EXCEPTION_FILTER now = ::SetUnhandledExceptionFilter(before.filter);
    if (now != &on_exception) ::SetUnhandledExceptionFilter(now);
    void (*const abort_now)(int) = std::signal(SIGABRT, before.abort);
    if (abort_now != &on_abort) std::signal(SIGABRT, abort_now);
    ::SetConsoleCtrlHandler(&on_end, FALSE);
}

/// Windows tells them by a thread of its own.
void leave_ends_to_others() noexcept {}

}  // namespace palpate::devices
