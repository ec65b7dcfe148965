// The device `mouse`: a hand that follows the pointer, critically damped and of limited speed.
#include "palpate/devices/mouse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::devices {
namespace {

/// [s] Time constant of following the target: two frames of a screen.
constexpr double lag = 0.03;
/// [N mm] The torque that is shown goes so far, as that of a Phantom Premium 1.5/6DOF.
constexpr double shown_torque = 170;
/// [rad/s]
constexpr double fastest_turn = 4 * std::numbers::pi;
/// A gap between two reads counts as no more [s].
constexpr double longest_gap = 0.02;

/// [mm] Half of the usable box, into which a volume is fitted, and of what can be reached: room to
/// go round the volume's corners.
const Vec3 workspace(80, 80, 80), reach(160, 160, 160);
/// [mm] Where the hand begins, in front of the volume.
const Vec3 begin(0, 0, 100);

}  // namespace

DeviceFinding find_mouse() {
    DeviceFinding finding;
    finding.name = "mouse";
    finding.found = true;
    finding.what = "pointer and keys, in the viewer's window only";
    finding.options = "speed=600 [mm/s]";
    return finding;
}

std::unique_ptr<Device> open_mouse(const DeviceChoice& choice, const DeviceScene&) {
    DeviceOptions options(choice, "speed");
    const double speed = options.number("speed", 600, 1, 5000);
    options.finish();
    return std::make_unique<Mouse>(speed);
}

Mouse::Mouse(double speed)
    : aim_{begin, Quaternion::Identity()}, speed_(speed), target_(aim_), position_(begin) {}

void Mouse::aim(const Vec3& position) noexcept {
    if (!position.allFinite()) return;
    aim_.position = position.cwiseMax(-reach).cwiseMin(reach);
    going_.put(aim_);
}

void Mouse::turn(const Quaternion& orientation) noexcept {
    const double norm = orientation.norm();
    if (!(norm > 0 && norm < 1e100)) return;
    aim_.orientation = orientation.normalized();
    going_.put(aim_);
}

DeviceInfo Mouse::info() const {
    DeviceInfo info;
    info.name = "mouse";
    info.model = "the window's pointer";
    info.workspace_low = -workspace;
    info.workspace_high = workspace;
    info.renders_force = false;
    info.has_orientation = true;
    info.limits.maximum_torque = shown_torque;
    return info;
}

DeviceReading Mouse::read(double time) noexcept {
    const double dt = moving_ ? std::clamp(time - time_, 0.0, longest_gap) : 0;
    time_ = time;
    moving_ = true;
    target_ = going_.get().value_or(target_);
    // Implicit Euler of x'' = w^2 (target - x) - 2 w x', w = 2 / lag: stable for every dt.
    const double w = 2 / lag;
    velocity_ = (velocity_ + dt * w * w * (target_.position - position_)) /
                (1 + 2 * w * dt + w * w * dt * dt);
    const double speed = velocity_.norm();
    if (speed > speed_) velocity_ *= speed_ / speed;
    position_ += dt * velocity_;
    const Vec3 left = rotation_between(orientation_, target_.orientation);
    const double angle = left.norm();
    if (angle > 0) {
        const double step = std::min(angle * -std::expm1(-dt / lag), dt * fastest_turn);
        orientation_ = turned(orientation_, left * (step / angle));
    }
    DeviceReading reading;
    reading.position = position_;
    reading.orientation = orientation_.toRotationMatrix();
    reading.status = DeviceStatus::ready;
    return reading;
}

}  // namespace palpate::devices
