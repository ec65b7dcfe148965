// The device `mouse`: a hand that follows the pointer, critically damped and of limited speed.
#include "palpate/devices/mouse.hpp"

#include <algorithm>

namespace palpate::devices {
namespace {

/// [s] Time constant of following the target: two frames of a screen.
constexpr double lag = 0.03;
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

Mouse::Mouse(double speed) : aim_(begin), speed_(speed), target_(aim_), position_(aim_) {}

void Mouse::aim(const Vec3& position) noexcept {
    if (!position.allFinite()) return;
    aim_ = position.cwiseMax(-reach).cwiseMin(reach);
    going_.put(aim_);
}

DeviceInfo Mouse::info() const {
    DeviceInfo info;
    info.name = "mouse";
    info.model = "the window's pointer";
    info.workspace_low = -workspace;
    info.workspace_high = workspace;
    info.renders_force = false;
    return info;
}

DeviceReading Mouse::read(double time) noexcept {
    const double dt = moving_ ? std::clamp(time - time_, 0.0, longest_gap) : 0;
    time_ = time;
    moving_ = true;
    target_ = going_.get().value_or(target_);
    // Implicit Euler of x'' = w^2 (target - x) - 2 w x', w = 2 / lag: stable for every dt.
    const double w = 2 / lag;
    velocity_ =
        (velocity_ + dt * w * w * (target_ - position_)) / (1 + 2 * w * dt + w * w * dt * dt);
    const double speed = velocity_.norm();
    if (speed > speed_) velocity_ *= speed_ / speed;
    position_ += dt * velocity_;
    DeviceReading reading;
    reading.position = position_;
    reading.status = DeviceStatus::ready;
    return reading;
}

}  // namespace palpate::devices
