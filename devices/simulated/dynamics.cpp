// The implicit step of the dynamics, quantisation by motors and encoders, and delayed wrenches.
#include "devices/simulated/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::devices {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The vector in whole steps, each component rounded by `rounding`. Not Eigen's round(), whose bits
/// depend on the instructions it is compiled for.
template <class Rounding>
Vec3 in_steps(const Vec3& v, double step, Rounding rounding) {
    return Vec3(rounding(v[0] / step), rounding(v[1] / step), rounding(v[2] / step)) * step;
}

/// The force or torque that a motor gives for a command.
Vec3 limited_in_steps(Vec3 wanted, double maximum, double step) {
    if (!wanted.allFinite()) return Vec3::Zero();  // stableNorm() of (0, NaN, 0) is 0
    const double strength = wanted.stableNorm();
    if (strength > maximum) wanted *= maximum / strength;
    if (!(step > 0)) return wanted;
    const Vec3 nearest = in_steps(wanted, step, [](double v) { return std::round(v); });
    if (nearest.norm() <= maximum) return nearest;
    return in_steps(wanted, step, [](double v) { return std::trunc(v); });
}

/// The velocity at the end of an implicit step, of translation or rotation alike. `mass` is M or J
/// as force by acceleration; `to_target` the way, or the rotation, to the target. With
/// x = x_before + dt v the step reads (weight) v + dt friction(v) = momentum.
template <class System>
Vec3 velocity_after(const System& s, double mass, const Vec3& to_target,
                    const Vec3& target_velocity, const Vec3& motors, double dt) {
    const double weight = mass + dt * (s.damping + s.hand_damping) + dt * dt * s.hand_stiffness;
    const Vec3 momentum = mass * s.velocity + dt * (motors + s.hand_damping * target_velocity +
                                                    s.hand_stiffness * to_target);
    const double strength = momentum.norm();
    const double held = dt * s.friction;
    if (strength <= held) return Vec3::Zero();
    return momentum * ((1 - held / strength) / weight);
}

}  // namespace

HandAndDevice hand_and_device(const DeviceProfile& device, const HandGrip& hand,
                              const Vec3& position) {
    return {.mass = device.mass + hand.mass,
            .damping = device.damping,
            .friction = device.friction,
            .hand_damping = hand.damping,
            .hand_stiffness = hand.stiffness,
            .position = position,
            .velocity = Vec3::Zero()};
}

TurningHandAndDevice turning_hand_and_device(const DeviceProfile& device, const HandGrip& hand,
                                             const Quaternion& orientation) {
    return {.inertia = device.inertia + hand.inertia,
            .damping = device.rotational_damping,
            .friction = device.rotational_friction,
            .hand_damping = hand.rotational_damping,
            .hand_stiffness = hand.rotational_stiffness,
            .orientation = orientation,
            .velocity = Vec3::Zero()};
}

void advance(HandAndDevice& s, const Vec3& target, const Vec3& target_velocity,
             const Vec3& motor_force, double dt) noexcept {
    const double mass = 1e-3 * s.mass;  // [N s^2/mm]
    s.velocity = velocity_after(s, mass, target - s.position, target_velocity, motor_force, dt);
    s.position += dt * s.velocity;
}

void advance(TurningHandAndDevice& s, const Quaternion& target, const Vec3& target_velocity,
             const Vec3& motor_torque, double dt) noexcept {
    const double inertia = 1e-3 * s.inertia;  // [N mm s^2]
    const Vec3 to_target = rotation_between(s.orientation, target);
    s.velocity = velocity_after(s, inertia, to_target, target_velocity, motor_torque, dt);
    if (!s.velocity.isZero(0)) s.orientation = turned(s.orientation, dt * s.velocity);
}

Vec3 motor_force(const DeviceProfile& device, const Vec3& commanded) noexcept {
    return limited_in_steps(commanded, device.maximum_force, device.force_step);
}

Vec3 motor_torque(const DeviceProfile& device, const Vec3& commanded) noexcept {
    return limited_in_steps(commanded, device.maximum_torque, device.torque_step);
}

Vec3 encoder_position(const DeviceProfile& device, const Vec3& position) noexcept {
    const double step = device.encoder_step;
    if (!(step > 0)) return position;
    return in_steps(position, step, [](double v) { return std::round(v); });
}

Quaternion encoder_orientation(const DeviceProfile& device,
                               const Quaternion& orientation) noexcept {
    const double step = device.angle_step;
    if (!(step > 0)) return orientation;
    const Vec3 angles = rotation_between(Quaternion::Identity(), orientation);
    return turned(Quaternion::Identity(),
                  in_steps(angles, step, [](double v) { return std::round(v); }));
}

WrenchLine::WrenchLine(double delay, double longest, std::size_t room)
    : delay_(delay),
      longest_(longest),
      ring_(std::max<std::size_t>(1, room)),
      last_arrival_(-infinity) {
    acting_.arrival = -infinity;
}

void WrenchLine::send(const Wrench& wrench, double time) noexcept {
    // A time that is NaN counts as the last one, too.
    const double arrival = time + delay_ > last_arrival_ ? time + delay_ : last_arrival_;
    if (count_ < ring_.size()) ++count_;
    ring_[(first_ + count_ - 1) % ring_.size()] = {wrench, arrival};
    last_arrival_ = arrival;
}

WrenchLine::Acting WrenchLine::at(double time) noexcept {
    while (count_ > 0 && ring_[first_].arrival <= time) {
        acting_ = ring_[first_];
        first_ = (first_ + 1) % ring_.size();
        --count_;
    }
    const double next = count_ > 0 ? ring_[first_].arrival : infinity;
    const double gone = acting_.arrival + longest_;
    if (time >= gone) return {Wrench{}, next};
    return {acting_.wrench, std::min(next, gone)};
}

}  // namespace palpate::devices
