// Exchanges the newest reading and the newest force between a backend's thread and the servo
// thread. Neither side waits for the other. Every backend that does I/O consists of a thread and a
// Link. Time is an argument, `now` [ns, monotonic], so that tests need not wait for it to pass.
#pragma once

#include <atomic>
#include <cstdint>

#include "palpate/device.hpp"
#include "palpate/exchange.hpp"

namespace palpate::devices {

class Link {
  public:
    // The servo's side.

    /// The newest reading with its age. A reading older than `Device::longest_force` is stale,
    /// whatever its status.
    DeviceReading read(std::int64_t now) const noexcept;
    /// Sets force and torque (device axes).
    void write(const Wrench& wrench, std::int64_t now) noexcept;

    // The backend's side, one thread.

    /// Reports a reading, measured `reading.age` ago.
    void report(const DeviceReading& reading, std::int64_t now) noexcept;
    /// Reports that the device is not ready and has no position: starting, lost, ... The last
    /// position stays.
    void report(DeviceStatus status, std::int64_t now) noexcept;
    /// The force and torque to send now: zero if none was set, if the last one is older than
    /// `Device::longest_force` (the servo has stalled or stopped), if a number is not finite, or
    /// after stop(). A backend sends it at least every 5 ms, changed or not, and takes no locks and
    /// allocates nothing in doing so.
    Wrench wrench(std::int64_t now) const noexcept;
    /// Whether the servo has set a wrench within `Device::longest_force`, and has not stopped. For
    /// a force that a device makes itself.
    bool is_driven(std::int64_t now) const noexcept;

    // Either side.

    /// From now on wrench() returns zero. Safe in a signal handler.
    void stop() noexcept;
    bool stopped() const noexcept;
    /// True from stop() until the backend has come back from sending the zero: it has asked for the
    /// wrench twice. For Device::is_stopping().
    bool stopping() const noexcept;

  private:
    struct Sent {
        double force[3], torque[3];
        std::int64_t at;  // [ns]
    };
    struct Report {
        DeviceReading reading;
        std::int64_t at;
    };
    Newest<Report> reading_;
    Newest<Sent> wrench_;
    DeviceReading last_;  // the backend's
    std::atomic<bool> stopped_{false};
    mutable std::atomic<int> zeros_{0};  // asked for since stop(), 2 at most
};

/// [s] of DeviceLimits::delay for a device whose thread steps every `period` [s]: a reading waits
/// one of them for the servo, at most, and a force as long for the thread. Between them the servo
/// renders, in 0.1 ms (p99.9 is 0.07 ms: docs/results/soak.md).
constexpr double exchange_delay(double period) {
    return 2 * period + 1e-4;
}

/// What a thread that talks to a device does first. Asks the system to wake it in time: exact
/// timers, and SCHED_FIFO just above the servo's priority, where that is granted (the servo's
/// privileges report what was not). Leaves signals to the other threads, but for its own crashes:
/// while a handler waits for the zero (LastResort), this thread has to send it.
void prepare_device_thread() noexcept;
/// Whether the thread that asks is one of those. Safe in a signal handler.
bool is_device_thread() noexcept;

/// The machine's monotonic clock [ns].
std::int64_t monotonic_ns() noexcept;
/// Sleeps until a time of it, as exactly as the system can once the thread is prepared.
void sleep_until(std::int64_t ns) noexcept;

/// Where a backend takes the time from [ns] and how it waits: the machine, or a test that lets time
/// pass itself. A backend's thread only calls the backend's step() in a loop; tests call it, too.
struct Timing {
    Clock now = &monotonic_ns;
    void (*sleep_until)(std::int64_t ns) noexcept = &devices::sleep_until;
};

}  // namespace palpate::devices
