// The servo's device, with a watchdog: a thread that takes the force away when a call to the device
// does not return. A device that throws loses its force, too.
#pragma once

#include <atomic>
#include <thread>

#include "palpate/servo.hpp"
#include "servo/clocks.hpp"

namespace palpate {

/// Once the device has failed, it is not called any more, but for its stop().
class WatchedDevice {
  public:
    explicit WatchedDevice(Device& device) : device_(device) {}
    /// Ends the watch.
    ~WatchedDevice();
    WatchedDevice(const WatchedDevice&) = delete;
    WatchedDevice& operator=(const WatchedDevice&) = delete;

    /// Starts the watchdog, with SCHED_FIFO of this priority where that is granted; 0: not asked
    /// for. Throws std::system_error if the system gives no thread.
    void watch(int priority);

    // Servo thread: no lock, no allocation.

    /// Says that the calling thread is the one to watch. Before its first call.
    void watch_this_thread() noexcept;
    // Where one of these fails, failure() says so afterwards.
    DeviceReading read(double time) noexcept;
    void write(const Wrench& wrench, double time) noexcept;

    // Any thread.

    DeviceFailure failure() const noexcept;

  private:
    template <class Call>
    bool guarded(Call&& call) noexcept;
    void look_after() noexcept;

    Device& device_;
    /// Counts begins and ends of calls: odd while one is under way. The two largest values say that
    /// the device has failed. One word, so that a call either returns or is given up.
    std::atomic<std::uint64_t> calls_{0};
    std::atomic<ThreadId> thread_{};  // of the servo
    std::atomic<bool> done_{false};
    std::thread watchdog_;
};

}  // namespace palpate
