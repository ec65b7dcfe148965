// The device `mouse`: a window's pointer and keys move the hand. The force is shown, not felt. See
// docs/devices/mouse.md.
#pragma once

#include <memory>

#include "palpate/devices/backend.hpp"
#include "palpate/exchange.hpp"
#include "palpate/tool.hpp"

namespace palpate::devices {

/// Always found. It needs a window to move it.
DeviceFinding find_mouse();

/// A Mouse. Throws std::invalid_argument for options it has not.
std::unique_ptr<Device> open_mouse(const DeviceChoice& choice, const DeviceScene& scene);

/// A hand that goes where a window's pointer aims. Pointers jump a hundred times a second. The hand
/// follows smoothly, a thousand times, never faster than its speed, and turns no faster than two
/// turns a second. Axes and workspace as of every
/// device: x to the right, y up, z towards the person. Begins in front of the volume,
/// before the person.
class Mouse final : public Device {
  public:
    /// `speed` [mm/s]: the hand's greatest.
    explicit Mouse(double speed);

    /// Sets the target of the hand [device mm], cut to twice the workspace. Ignores a target that
    /// is not finite. Called by one thread, the window's.
    void aim(const Vec3& position) noexcept;
    /// The target of the hand. Called by the thread that aims.
    const Vec3& aimed() const noexcept { return aim_.position; }
    /// How the tool is to be turned (tool axes to device axes), by the shortest way. Not finite or
    /// zero: nothing happens. By the thread that aims.
    void turn(const Quaternion& orientation) noexcept;
    const Quaternion& turned_to() const noexcept { return aim_.orientation; }

    DeviceInfo info() const override;
    DeviceReading read(double time) noexcept override;
    /// Forces reach no motor.
    void write(const Wrench&, double) noexcept override {}
    void stop() noexcept override {}

  private:
    Pose aim_;            // the window's
    Newest<Pose> going_;  // from the window to the servo
    // The servo's.
    double speed_;
    Pose target_;
    Vec3 position_, velocity_ = Vec3::Zero();
    Quaternion orientation_ = Quaternion::Identity();
    double time_ = 0;
    bool moving_ = false;
};

}  // namespace palpate::devices
