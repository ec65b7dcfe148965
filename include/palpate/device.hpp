// Stage 12, device: the interface of a haptic device, which gives poses and takes wrenches.
// Backends for real and simulated devices are in the folder devices/.
#pragma once

#include <optional>
#include <string>

#include "palpate/renderer.hpp"

namespace palpate {

/// State of a device. There is force only while it is `ready`.
enum class DeviceStatus : std::uint8_t {
    starting,      ///< not connected yet, or no position yet
    ready,         ///< positions arrive
    uncalibrated,  ///< positions cannot be trusted before it is calibrated
    stale,         ///< the last position is too old
    lost,          ///< the connection is lost. It may return
    fault,         ///< the device or its driver reports an error
    finished,      ///< a recorded or scripted hand has reached its end
};
const char* name_of(DeviceStatus status);

/// Properties of a device. Lengths in device mm. The axes are the same for all devices: x to the
/// right, y up, z towards the person who holds it.
struct DeviceInfo {
    std::string name;        ///< of the backend: simulated, haply, ...
    std::string model;       ///< as the device reports it, with the serial number if it has one
    DeviceLimits limits;     ///< never exceeded by a servo, whatever the settings
    double stiffness = 0.5;  ///< [N/mm] it is rated for. A hint for applications, not a limit
    Vec3 workspace_low = Vec3::Constant(-80);
    Vec3 workspace_high = Vec3::Constant(80);  ///< corners of the usable box [device mm]
    bool renders_force = true;                 ///< false: position only
    bool renders_torque = false;               ///< false: the torque of a wrench is ignored
    bool has_orientation = false;
    bool has_gripper = false;
    int buttons = 0;
};

/// Throws std::invalid_argument, which begins with the name of the member, for a workspace, a
/// stiffness or a number of buttons that no device has. The limits have a check of their own.
void check(const DeviceInfo& info);

/// Orientations of devices count as rotations up to this tolerance of is_rotation(): many have few
/// digits.
inline constexpr double orientation_tolerance = 1e-3;

/// The newest measurement of a device.
struct DeviceReading {
    Vec3 position = Vec3::Zero();  ///< [device mm]
    /// Tool axes to device axes; identity if not known. One that is no rotation, to
    /// orientation_tolerance, is ignored.
    Mat3 orientation = Mat3::Identity();
    std::uint32_t buttons = 0;           ///< bit b is set while button b is held
    std::optional<double> opening = {};  ///< [rad] of a gripper, 0: closed. None: it has none
    double age = 0;                      ///< [s] since it was measured. Below 0, NaN, inf: stale
    DeviceStatus status = DeviceStatus::starting;
    /// Limits of a device that learns them only when it connects, in every reading from then on.
    /// None: those that info() gave when the servo was constructed still hold.
    std::optional<DeviceLimits> limits = std::nullopt;
};

/// Whether the gripper is closed so far that it grasps. Always true for a device without a gripper.
constexpr bool grasps(const DeviceReading& reading) {
    return !reading.opening || *reading.opening < 0.1;
}

/// The side of the body that faces the person at the device. Physical space is LPS (x to the left,
/// y to the back, z up), so in an anterior view the patient's left is at the right.
enum class Facing : std::uint8_t { anterior, posterior, left, right, superior, inferior };

/// The transform that fits the whole grid into the device's workspace, centre on centre, with this
/// side facing the person.
DeviceTransform fit_workspace(const Geometry& geometry, const DeviceInfo& device,
                              Facing facing = Facing::anterior);

/// A haptic device. The constructors of backends (devices/) connect to it or begin to try. If that
/// cannot succeed, they throw std::runtime_error, which says what was missing and what to do.
/// Destroying a device sets its force to zero and closes it.
class Device {
  public:
    Device() = default;
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    virtual ~Device() = default;

    /// Any thread but the servo thread. May change when a device connects. A running servo learns
    /// of changed limits by DeviceReading::limits.
    virtual DeviceInfo info() const = 0;
    /// A problem and its remedy, or empty. Not for the servo thread.
    virtual std::string problem() const { return {}; }

    /// Servo thread: neither waits, allocates nor throws. `time` [s] is the session's. Simulated
    /// devices follow it. Hardware devices measure ages by the machine's clock. A servo ends its
    /// session, with stop(), when this or write() throws or does not return within 10 ms
    /// (DeviceFailure).
    virtual DeviceReading read(double time) = 0;
    /// Servo thread, as above. A wrench (device axes; the torque is about the point whose position
    /// read() gives) holds until the next one, but no longer than `longest_force`. Then the
    /// device's own thread sets it to zero. A device without torque renders the force alone.
    virtual void write(const Wrench& wrench, double time) = 0;
    static constexpr double longest_force = 0.02;  ///< [s]

    /// Permanently sets force and torque to zero, whatever write() gets later or at the same time.
    /// May be called by any thread and in signal handlers: a program that crashes calls it as a
    /// last resort. It works while another thread hangs in read() or write(), so it must not wait
    /// for anything that such a thread holds. If the force of a device cannot be stopped from a
    /// second thread, problem() and the documentation of the device say so.
    virtual void stop() noexcept = 0;
    /// After stop(): true until the zero has been sent, if the device can tell. Any thread, and
    /// signal handlers.
    virtual bool is_stopping() const noexcept { return false; }
};

}  // namespace palpate
