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

/// Opens a Mouse. Throws std::invalid_argument for unknown options.
std::unique_ptr<Device> open_mouse(const DeviceChoice& choice, const DeviceScene& scene);

/// A hand that follows the pointer of a window. A pointer jumps up to a hundred times a second. The
/// hand follows smoothly, a thousand times a second, never faster than its speed and two turns a
/// second. Axes and workspace are those of every device: x to the right, y up, z towards the
/// person. The hand begins in front of the volume.
class Mouse final : public Device {
  public:
    /// `speed` [mm/s]: the hand's greatest.
    explicit Mouse(double speed);

    /// Sets the target of the hand [device mm], cut to twice the workspace. Ignores a target that
    /// is not finite. Called by one thread, the window's.
    void aim(const Vec3& position) noexcept;
    /// The target of the hand. Called by the thread that aims.
    const Vec3& aimed() const noexcept { return aim_.position; }
    /// Sets the target orientation of the tool (tool axes to device axes), which it reaches by the
    /// shortest way. Ignores one that is not finite or zero. Called by the thread that aims.
    void turn(const Quaternion& orientation) noexcept;
    const Quaternion& turned_to() const noexcept { return aim_.orientation; }

    DeviceInfo info() const override;
    DeviceReading read(double time) noexcept override;
    /// Ignored: a mouse has no motor.
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
