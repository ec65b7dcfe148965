// Stage 13, device: what the hand holds. A device gives positions and takes forces; how it is
// reached is its own affair (folder devices/).
#pragma once

#include <optional>
#include <string>

#include "palpate/renderer.hpp"

namespace palpate {

/// How a device is doing. Anything but `ready` means: no force.
enum class DeviceStatus : std::uint8_t {
    starting,      ///< not connected yet, or no position yet
    ready,         ///< positions come in
    uncalibrated,  ///< positions cannot be trusted before it is calibrated
    stale,         ///< the last position is too old
    lost,          ///< the connection is gone; it may come back
    fault,         ///< the device or its driver reports an error
    finished,      ///< a recorded or scripted hand has come to its end
};
const char* name_of(DeviceStatus status);

/// What a device is and can take. Lengths in device mm, in the axes of every device here: x to the
/// right, y up, z towards the person who holds it.
struct DeviceInfo {
    std::string name;        ///< of the backend: simulated, haply, ...
    std::string model;       ///< as the device tells it, serial number included where there is one
    DeviceLimits limits;     ///< never exceeded by a servo, whatever the settings
    double stiffness = 0.5;  ///< [N/mm] it is rated for; a hint for applications, not a limit
    Vec3 workspace_low = Vec3::Constant(-80);
    Vec3 workspace_high = Vec3::Constant(80);  ///< corners of the usable box [device mm]
    bool renders_force = true;                 ///< false: position only
    bool has_orientation = false;
    int buttons = 0;
};

/// What a device told last.
struct DeviceReading {
    Vec3 position = Vec3::Zero();         ///< [device mm]
    Mat3 orientation = Mat3::Identity();  ///< tool axes to device axes; identity if unknown
    std::uint32_t buttons = 0;            ///< bit b is set while button b is held
    double age = 0;                       ///< [s] since it was measured
    DeviceStatus status = DeviceStatus::starting;
    /// Limits of a device that learns them only when it connects, in every reading from then on;
    /// none: those that info() gave when the servo was made still hold.
    std::optional<DeviceLimits> limits = std::nullopt;
};

/// Which side of the body faces the person at the device. Physical space is LPS (x to the left, y
/// to the back, z up), so that an anterior view has the patient's left on the right hand.
enum class Facing : std::uint8_t { anterior, posterior, left, right, superior, inferior };

/// The transform with which the whole grid fits into the device's workspace, centre on centre,
/// with this side facing the person.
DeviceTransform fit_workspace(const Geometry& geometry, const DeviceInfo& device,
                              Facing facing = Facing::anterior);

/// A haptic device. Constructing one (devices/) connects to it or starts trying to; throws
/// std::runtime_error, saying what was looked for and what to do, where that is hopeless.
/// Destroying it sets its force to zero and closes it.
class Device {
  public:
    Device() = default;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    virtual ~Device() = default;

    /// Any thread but the servo thread. May change when a device connects; a running servo learns
    /// of changed limits by DeviceReading::limits.
    virtual DeviceInfo info() const = 0;
    /// What is wrong and what to do about it, in words; empty where all is well. Not for the servo
    /// thread.
    virtual std::string problem() const { return {}; }

    /// Servo thread: neither waits, allocates nor throws. `time` [s] is that of the session, which
    /// a simulated device follows; one of hardware measures ages by the machine's clock.
    virtual DeviceReading read(double time) noexcept = 0;
    /// Servo thread, as above. A force [N, device axes] holds until the next one, but for no longer
    /// than `longest_force`: after that the device's own thread sets it to zero.
    virtual void write(const Vec3& force, double time) noexcept = 0;
    static constexpr double longest_force = 0.02;  ///< [s]

    /// Zero force from now on, for good. May be called from any thread and from a signal handler:
    /// the last resort of a program that crashes.
    virtual void stop() noexcept = 0;
};

}  // namespace palpate
