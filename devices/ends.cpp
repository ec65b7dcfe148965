// Signal handlers that stop the devices. POSIX.
#include "devices/ends.hpp"

#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>

#include "devices/link.hpp"

namespace palpate::devices {
namespace {

/// Faults of the program itself: handled whatever was set up before.
constexpr std::array crashes{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP, SIGSYS};
/// Signals that cannot be caught, or that do not end or suspend a program.
constexpr std::array harmless{SIGKILL, SIGSTOP, SIGCHLD, SIGCONT, SIGURG, SIGWINCH};

/// What each signal that is handled here did before.
std::array<struct sigaction, 128> actions_before{};

/// On a stack of its own, for the crash may be that of a stack that has run out (of the thread that
/// made the LastResort; other threads have their guard page and no second stack).
alignas(16) std::array<char, 64 * 1024> handler_stack;

void on_signal(int number, siginfo_t* info, void* context) {
    const bool wait = stop_guarded();
    const bool was_sent = info->si_code <= 0;  // by someone: no fault of this thread
    if (was_sent && is_device_thread()) {
        // This thread has the zero to send: others take the signal from now on.
        ::sigaddset(&static_cast<ucontext_t*>(context)->uc_sigmask, number);
        ::kill(::getpid(), number);
        return;
    }
    if (wait) wait_for_zeros();
    // The signal's default action follows, because signals are held back until this returns.
    std::signal(number, SIG_DFL);
    ::raise(number);
}

bool has_default_action(int number) {
    struct sigaction now {};
    return ::sigaction(number, nullptr, &now) == 0 && (now.sa_flags & SA_SIGINFO) == 0 &&
           now.sa_handler == SIG_DFL;
}

bool has_our_handler(int number) {
    struct sigaction now {};
    return ::sigaction(number, nullptr, &now) == 0 && (now.sa_flags & SA_SIGINFO) != 0 &&
           now.sa_sigaction == &on_signal;
}

}  // namespace

void sleep_in_handler(int milliseconds) noexcept {
    timespec left{0, milliseconds * 1'000'000};
    while (::nanosleep(&left, &left) != 0 && errno == EINTR) {
    }
}

/// Every signal whose default action ends or suspends the program. What an application handles or
/// ignores stays its own, except for crashes.
void handle_ends() {
    stack_t stack{};
    stack.ss_sp = handler_stack.data();
    stack.ss_size = handler_stack.size();
    ::sigaltstack(&stack, nullptr);
    struct sigaction action {};
    action.sa_sigaction = &on_signal;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    ::sigfillset(&action.sa_mask);  // a signal that comes again waits for the zero as well
    for (int number = 1; number <= SIGRTMAX; ++number) {
        if (std::ranges::count(harmless, number) > 0 || has_our_handler(number)) continue;
        if (std::ranges::count(crashes, number) > 0 || has_default_action(number)) {
            // Fails for those that the C library keeps.
            ::sigaction(number, &action, &actions_before[static_cast<std::size_t>(number)]);
        }
    }
}

void forget_ends() {
    for (int number = 1; number <= SIGRTMAX; ++number) {
        if (!has_our_handler(number)) continue;
        ::sigaction(number, &actions_before[static_cast<std::size_t>(number)], nullptr);
    }
}

void leave_ends_to_others() noexcept {
    sigset_t others;
    ::sigfillset(&others);
    for (const int crash : crashes) ::sigdelset(&others, crash);
    ::pthread_sigmask(SIG_BLOCK, &others, nullptr);
}

}  // namespace palpate::devices
