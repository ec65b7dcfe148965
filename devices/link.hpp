// Between a backend's own thread and the servo thread: newest reading in, newest force out. Neither
// side ever waits for the other. Every backend that does I/O is a thread and one of these.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "palpate/device.hpp"
#include "palpate/exchange.hpp"

namespace palpate::devices {

class Link {
  public:
    // The servo's side.

    /// The newest reading with its age. A reading older than `Device::longest_force` is stale,
    /// whatever its status was.
    DeviceReading read() const noexcept;
    /// Sets the force [N, device axes].
    void write(const Vec3& force) noexcept;

    // The backend's side, one thread.

    /// A reading that was measured just now (`reading.age` before).
    void report(const DeviceReading& reading) noexcept;
    /// The device is not ready and there is no position: starting, lost, ... The last position
    /// stays.
    void report(DeviceStatus status) noexcept;
    /// The force to send now: zero if none was set, if the last one is older than
    /// `Device::longest_force` (the servo has stalled or stopped), if it is not finite, or after
    /// stop(). A backend sends it at least every 5 ms, whether it has changed or not, and is not
    /// held up by locks or memory while doing so.
    Vec3 force() const noexcept;

    // Either side.

    /// Zero for good: force() never gives anything else again. Safe in a signal handler.
    void stop() noexcept;
    bool stopped() const noexcept;

  private:
    struct Force {
        double force[3];
        std::int64_t at;  // [ns] monotonic
    };
    struct Report {
        DeviceReading reading;
        std::int64_t at;
    };
    Newest<Report> reading_;
    Newest<Force> force_;
    DeviceReading last_;  // the backend's
    std::atomic<bool> stopped_{false};
};

/// Asks the system to wake the calling thread in time: exact timers, and SCHED_FIFO just above the
/// servo's priority, where that is granted (what was not, the servo's privileges tell). For threads
/// that talk to a device and wait most of the time.
void ask_for_real_time_thread() noexcept;

/// The machine's monotonic clock [ns].
std::int64_t monotonic_ns() noexcept;

}  // namespace palpate::devices
