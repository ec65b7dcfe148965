// Signal handlers that stop the device. A handler can reach a global only: this is the one writable
// global of the devices.
#include "palpate/devices/last_resort.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <stdexcept>

namespace palpate::devices {
namespace {

constexpr std::array crashes{SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};

std::array<std::atomic<Device*>, LastResort::most> guarded{};

/// On a stack of its own, for the crash may be that of a stack that has run out (of the thread that
/// made the LastResort; other threads have their guard page and no second stack).
alignas(16) std::array<char, 64 * 1024> handler_stack;

void on_crash(int number) {
    bool stopped = false;
    for (std::atomic<Device*>& place : guarded) {
        Device* const device = place.exchange(nullptr);
        if (!device) continue;
        device->stop();
        stopped = true;
    }
    if (stopped) {
        timespec wait{0, 25'000'000};
        while (::nanosleep(&wait, &wait) != 0 && errno == EINTR) {
        }
    }
    // The default action is restored (SA_RESETHAND): the crash continues.
    ::raise(number);
}

}  // namespace

LastResort::LastResort(Device& device) {
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
    guarded[place_].store(nullptr);
    const bool last = std::ranges::none_of(guarded, [](const auto& place) { return place.load(); });
    if (!last) return;
    for (const int number : crashes) std::signal(number, SIG_DFL);
}

}  // namespace palpate::devices
