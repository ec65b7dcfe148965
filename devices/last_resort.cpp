// Signal handlers that stop the device. A handler can reach a global only: this is the one writable
// global of the devices.
#include "palpate/devices/last_resort.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <stdexcept>

namespace palpate::devices {
namespace {

constexpr std::array crashes{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};

std::atomic<Device*> guarded{nullptr};

/// On a stack of its own, for the crash may be that of a stack that has run out (of the thread that
/// made the LastResort; other threads have their guard page and no second stack).
alignas(16) std::array<char, 64 * 1024> handler_stack;

void on_crash(int number) {
    if (Device* device = guarded.exchange(nullptr)) {
        device->stop();
        timespec wait{0, 25'000'000};
        while (::nanosleep(&wait, &wait) != 0 && errno == EINTR) {
        }
    }
    // The default action is restored (SA_RESETHAND): the crash continues.
    ::raise(number);
}

}  // namespace

LastResort::LastResort(Device& device) {
    Device* nobody = nullptr;
    if (!guarded.compare_exchange_strong(nobody, &device)) {
        throw std::logic_error("there is a last resort already");
    }
    stack_t stack{};
    stack.ss_sp = handler_stack.data();
    stack.ss_size = handler_stack.size();
    ::sigaltstack(&stack, nullptr);
    struct sigaction action {};
    action.sa_handler = &on_crash;
    action.sa_flags = SA_RESETHAND | SA_ONSTACK | SA_NODEFER;
    for (const int number : crashes) ::sigaction(number, &action, nullptr);
}

LastResort::~LastResort() {
    for (const int number : crashes) std::signal(number, SIG_DFL);
    guarded.store(nullptr);
}

}  // namespace palpate::devices
