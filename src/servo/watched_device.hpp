// The servo's device, with a watchdog that takes the force away when a call to the device does not
// return. A device that throws loses its force, too.
#pragma once

#include <atomic>
#include <thread>

#include "palpate/servo.hpp"
#include "servo/clocks.hpp"

namespace palpate {

/// What a thread does: its CPU time in all [ns], and whether it waits for nothing but a processor.
struct ThreadUse {
    std::int64_t cpu = 0;
    bool could_run = false;
};

/// Once the device has failed, it is not called any more, but for its stop().
class WatchedDevice {
  public:
    explicit WatchedDevice(Device& device) : device_(device) {}
    /// Ends the watch.
    ~WatchedDevice();
    WatchedDevice(const WatchedDevice&) = delete;
    WatchedDevice& operator=(const WatchedDevice&) = delete;

    /// Starts a thread that looks every 5 ms, with SCHED_FIFO of this priority where that is
    /// granted; 0: not asked for. Throws std::system_error if the system gives no thread.
    void watch(int priority);
    /// One look at the call under way, 5 ms after the one before. One thread.
    void look(const ThreadUse& servo) noexcept;

    // Servo thread: no lock, no allocation.

    /// Says that the calling thread is the one to watch. Before its first call.
    void watch_this_thread() noexcept;
    // Where one of these fails, failure() says so afterwards.
    DeviceReading read(double time) noexcept;
    void write(const Wrench& wrench, double time) noexcept;

    // Any thread.

    DeviceFailure failure() const noexcept;
    /// Whether a call that hangs has cost the device its force: Device::stop() has returned.
    bool has_lost_force() const noexcept { return lost_force_.load(std::memory_order_acquire); }
    /// From the look that gives up a call until then.
    bool is_losing_force() const noexcept {
        return failure() == DeviceFailure::hung && !has_lost_force();
    }

  private:
    template <class Call>
    bool guarded(Call&& call) noexcept;
    void look_on() noexcept;
    bool is_calling() const noexcept;

    Device& device_;
    /// Counts begins and ends of calls: odd while one is under way. The two largest values say that
    /// the device has failed. One word, so that a call either returns or is given up.
    std::atomic<std::uint64_t> calls_{0};
    std::atomic<ThreadId> thread_{};  // of the servo
    std::atomic<bool> done_{false}, lost_force_{false};
    std::thread watchdog_;

    // Of the one that looks.
    std::uint64_t seen_ = 0;            // the call
    std::int64_t cpu_ = 0, spent_ = 0;  // [ns] by the thread: in all, and in the call
};

}  // namespace palpate
