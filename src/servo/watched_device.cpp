// Tells a call that hangs: the watchdog sees it under way at three looks in a row, between which
// its thread has waited or computed and not been kept from running by the machine.
#include "servo/watched_device.hpp"

#include <utility>

#include "servo/privileges.hpp"

namespace palpate {
namespace {

constexpr std::uint64_t has_hung = ~std::uint64_t{0};
constexpr std::uint64_t has_thrown = has_hung - 1;

/// A call is given up at the third look that sees it: 10 to 15 ms after it began. What is left of
/// Device::longest_force is for a watchdog that is woken late, and for the device's own thread.
constexpr std::int64_t between_looks_ns = 5'000'000;
constexpr std::int64_t longest_call_ns = 7'500'000;  // between the looks that see it

}  // namespace

WatchedDevice::~WatchedDevice() {
    done_.store(true);
    if (watchdog_.joinable()) watchdog_.join();
}

void WatchedDevice::watch(int priority) {
    watchdog_ = std::thread([this, priority] {
        if (priority > 0) take_priority(priority);
        look_on();
    });
}

void WatchedDevice::watch_this_thread() noexcept {
    thread_.store(calling_thread());
}

/// False if the device has failed: then, or before.
template <class Call>
bool WatchedDevice::guarded(Call&& call) noexcept {
    std::uint64_t count = calls_.load(std::memory_order_relaxed);
    if (count >= has_thrown) return false;
    calls_.store(++count, std::memory_order_release);  // nobody else changes an even count
    try {
        call();
    } catch (...) {
        // A call that was given up before it threw has hung.
        calls_.compare_exchange_strong(count, has_thrown);
        device_.stop();
        return false;
    }
    return calls_.compare_exchange_strong(count, count + 1);
}

DeviceReading WatchedDevice::read(double time) noexcept {
    DeviceReading reading;
    guarded([&] { reading = device_.read(time); });
    return reading;
}

void WatchedDevice::write(const Wrench& wrench, double time) noexcept {
    guarded([&] { device_.write(wrench, time); });
}

DeviceFailure WatchedDevice::failure() const noexcept {
    switch (calls_.load(std::memory_order_acquire)) {
        case has_hung:
            return DeviceFailure::hung;
        case has_thrown:
            return DeviceFailure::threw;
        default:
            return DeviceFailure::none;
    }
}

bool WatchedDevice::is_calling() const noexcept {
    const std::uint64_t count = calls_.load(std::memory_order_acquire);
    return count < has_thrown && count % 2 != 0;
}

void WatchedDevice::look_on() noexcept {
    Alarm alarm;
    while (!done_.load() && failure() == DeviceFailure::none) {
        alarm.sleep_until(monotonic_ns() + between_looks_ns);
        const ThreadId servo = thread_.load();
        if (is_calling()) look({cpu_ns(servo), is_runnable(servo)});
    }
}

void WatchedDevice::look(const ThreadUse& servo) noexcept {
    if (!is_calling()) return;
    std::uint64_t count = calls_.load(std::memory_order_acquire);
    const std::int64_t cpu_before = std::exchange(cpu_, servo.cpu);
    if (std::exchange(seen_, count) != count) {
        spent_ = 0;
        return;
    }
    // A thread that could run but gets no processor does not hang: the machine is to blame.
    spent_ += servo.could_run ? servo.cpu - cpu_before : between_looks_ns;
    if (spent_ < longest_call_ns || !calls_.compare_exchange_strong(count, has_hung)) return;
    device_.stop();
    lost_force_.store(true, std::memory_order_release);
}

}  // namespace palpate
