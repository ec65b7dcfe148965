// Signal handlers that stop the device. A handler can reach globals only: these are the writable
// globals of the devices.
#include "palpate/devices/last_resort.hpp"

#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <mutex>
#include <stdexcept>

#include "devices/link.hpp"

namespace palpate::devices {
namespace {

/// Faults of the program itself: handled whatever was set up before.
constexpr std::array crashes{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP, SIGSYS};
/// Signals that cannot be caught, or that do not end or suspend a program.
constexpr std::array harmless{SIGKILL, SIGSTOP, SIGCHLD, SIGCONT, SIGURG, SIGWINCH};

std::mutex changes;  // of what is guarded, by any thread; handlers do not take it
std::array<std::atomic<Device*>, LastResort::most> guarded{};
/// Devices that a handler has told to stop.
std::array<std::atomic<Device*>, LastResort::most> told{};

/// How long a handler waits [ms]: at least, for devices that cannot tell, and at most.
constexpr int least_wait = 100;
constexpr int most_wait = 1000;

void sleep_in_handler(int milliseconds) noexcept {
    timespec left{0, milliseconds * 1'000'000};
    while (::nanosleep(&left, &left) != 0 && errno == EINTR) {
    }
}
std::atomic<LastResort::Pause> pause_in_handler{&sleep_in_handler};

bool is_stopping(const std::atomic<Device*>& place) {
    const Device* const device = place.load();
    return device && device->is_stopping();
}

void wait_for_zeros() {
    constexpr int step = 5;
    for (int waited = 0; waited < most_wait; waited += step) {
        if (waited >= least_wait && std::ranges::none_of(told, is_stopping)) return;
        pause_in_handler.load()(step);
    }
}

/// On a stack of its own, for the crash may be that of a stack that has run out (of the thread that
/// made the LastResort; other threads have their guard page and no second stack).
alignas(16) std::array<char, 64 * 1024> handler_stack;

void on_signal(int number, siginfo_t* info, void* context) {
    bool wait = false;  // also for what another handler, on another thread, has told to stop
    for (std::size_t i = 0; i < guarded.size(); ++i) {
        if (Device* const device = guarded[i].load()) told[i].store(device);
        if (Device* const device = guarded[i].exchange(nullptr)) device->stop();
        wait = wait || told[i].load();
    }
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

/// Every signal whose default action ends or suspends the program. What an application handles or
/// ignores stays its own.
void handle_signals() {
    struct sigaction action {};
    action.sa_sigaction = &on_signal;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    ::sigfillset(&action.sa_mask);  // a signal that comes again waits for the zero as well
    for (int number = 1; number <= SIGRTMAX; ++number) {
        if (std::ranges::count(harmless, number) > 0) continue;
        if (std::ranges::count(crashes, number) > 0 || has_default_action(number)) {
            ::sigaction(number, &action, nullptr);  // fails for those that the C library keeps
        }
    }
}

void forget_signals() {
    for (int number = 1; number <= SIGRTMAX; ++number) {
        if (has_our_handler(number)) std::signal(number, SIG_DFL);
    }
}

}  // namespace

LastResort::LastResort(Device& device, Pause pause) {
    const std::lock_guard lock(changes);
    if (std::ranges::any_of(guarded, [&](const auto& place) { return place.load() == &device; })) {
        throw std::logic_error("this device has a last resort already");
    }
    const auto free_place = std::ranges::find_if(guarded, [&](std::atomic<Device*>& place) {
        Device* nobody = nullptr;
        return place.compare_exchange_strong(nobody, &device);
    });
    if (free_place == guarded.end()) {
        throw std::logic_error("too many devices are guarded against crashes at once");
    }
    place_ = static_cast<std::size_t>(free_place - guarded.begin());
    pause_in_handler.store(pause ? pause : &sleep_in_handler);
    stack_t stack{};
    stack.ss_sp = handler_stack.data();
    stack.ss_size = handler_stack.size();
    ::sigaltstack(&stack, nullptr);
    handle_signals();
}

LastResort::~LastResort() {
    const std::lock_guard lock(changes);
    guarded[place_].store(nullptr);
    told[place_].store(nullptr);
    const bool last = std::ranges::none_of(guarded, [](const auto& place) { return place.load(); });
    if (last) forget_signals();
}

}  // namespace palpate::devices
