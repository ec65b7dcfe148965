// Tells a call that hangs: the watchdog sees it under way at three looks in a row, between which
// its thread has waited or computed and not been kept from running by the machine. Linux.
#include "servo/watched_device.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <string_view>
#include <utility>

#include "servo/privileges.hpp"

namespace palpate {
namespace {

constexpr std::uint64_t has_hung = ~std::uint64_t{0};
constexpr std::uint64_t has_thrown = has_hung - 1;

/// A call is given up at the third look that sees it: 10 to 15 ms after it began. What is left of
/// Device::longest_force is for a watchdog that is woken late, and for the device's own thread.
constexpr std::chrono::nanoseconds between_looks = std::chrono::milliseconds(5);
constexpr std::int64_t longest_call_ns = 7'500'000;  // between the looks that see it

std::int64_t cpu_ns(clockid_t clock) noexcept {
    timespec time{};
    ::clock_gettime(clock, &time);
    return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

/// Whether the thread could run or does, as opposed to waiting in the call. False if the system
/// does not tell. Allocates nothing: the thread that hangs may hold the heap's lock.
bool is_runnable(int thread) noexcept {
    std::array<char, 64> path{};
    std::snprintf(path.data(), path.size(), "/proc/self/task/%d/stat", thread);
    const int file = ::open(path.data(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    std::array<char, 128> text{};
    const ssize_t size = ::read(file, text.data(), text.size());
    ::close(file);
    const std::string_view told(text.data(), static_cast<std::size_t>(std::max<ssize_t>(0, size)));
    const std::size_t name_end = told.rfind(')');
    return name_end != std::string_view::npos && told.substr(name_end).starts_with(") R");
}

}  // namespace

WatchedDevice::~WatchedDevice() {
    done_.store(true);
    if (watchdog_.joinable()) watchdog_.join();
}

void WatchedDevice::watch(int priority) {
    watchdog_ = std::thread([this, priority] {
        if (priority > 0) take_priority(priority);
        look_after();
    });
}

void WatchedDevice::watch_this_thread() noexcept {
    clockid_t clock{};
    ::pthread_getcpuclockid(::pthread_self(), &clock);
    thread_clock_.store(clock);
    thread_id_.store(::gettid());
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

void WatchedDevice::look_after() noexcept {
    std::uint64_t seen = 0;
    std::int64_t cpu = 0, spent = 0;  // [ns] by the thread: in all, and in the call
    while (!done_.load()) {
        std::this_thread::sleep_for(between_looks);
        std::uint64_t count = calls_.load(std::memory_order_acquire);
        if (count >= has_thrown) return;
        if (count % 2 == 0) continue;
        const std::int64_t cpu_before = std::exchange(cpu, cpu_ns(thread_clock_));
        if (std::exchange(seen, count) != count) {
            spent = 0;
            continue;
        }
        // A thread that could run but gets no processor does not hang: the machine is to blame.
        spent += is_runnable(thread_id_) ? cpu - cpu_before : between_looks.count();
        if (spent < longest_call_ns) continue;
        if (calls_.compare_exchange_strong(count, has_hung)) device_.stop();
    }
}

}  // namespace palpate
