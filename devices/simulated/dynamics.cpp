// The implicit step of the dynamics, quantisation by motors and encoders, and delayed forces.
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

void advance(HandAndDevice& s, const Vec3& target, const Vec3& target_velocity,
             const Vec3& motor_force, double dt) noexcept {
    const double mass = 1e-3 * s.mass;  // [N s^2/mm]
    // With x' = x + dt v', the step reads (weight) v' + dt friction(v') = momentum.
    const double weight = mass + dt * (s.damping + s.hand_damping) + dt * dt * s.hand_stiffness;
    const Vec3 momentum = mass * s.velocity + dt * (motor_force + s.hand_damping * target_velocity +
                                                    s.hand_stiffness * (target - s.position));
    const double strength = momentum.norm();
    const double held = dt * s.friction;
    if (strength <= held) {
        s.velocity.setZero();
        return;
    }
    s.velocity = momentum * ((1 - held / strength) / weight);
    s.position += dt * s.velocity;
}

Vec3 motor_force(const DeviceProfile& device, const Vec3& commanded) noexcept {
    Vec3 force = commanded;
    const double strength = force.stableNorm();
    if (!std::isfinite(strength)) return Vec3::Zero();
    if (strength > device.maximum_force) force *= device.maximum_force / strength;
    const double step = device.force_step;
    if (!(step > 0)) return force;
    const Vec3 nearest = in_steps(force, step, [](double v) { return std::round(v); });
    if (nearest.norm() <= device.maximum_force) return nearest;
    return in_steps(force, step, [](double v) { return std::trunc(v); });
}

Vec3 encoder_position(const DeviceProfile& device, const Vec3& position) noexcept {
    const double step = device.encoder_step;
    if (!(step > 0)) return position;
    return in_steps(position, step, [](double v) { return std::round(v); });
}

ForceLine::ForceLine(double delay, double longest, std::size_t room)
    : delay_(delay),
      longest_(longest),
      ring_(std::max<std::size_t>(1, room)),
      last_arrival_(-infinity) {
    acting_.arrival = -infinity;
}

void ForceLine::send(const Vec3& force, double time) noexcept {
    // A time that is NaN counts as the last one, too.
    const double arrival = time + delay_ > last_arrival_ ? time + delay_ : last_arrival_;
    if (count_ < ring_.size()) ++count_;
    ring_[(first_ + count_ - 1) % ring_.size()] = {force, arrival};
    last_arrival_ = arrival;
}

ForceLine::Acting ForceLine::at(double time) noexcept {
    while (count_ > 0 && ring_[first_].arrival <= time) {
        acting_ = ring_[first_];
        first_ = (first_ + 1) % ring_.size();
        --count_;
    }
    const double next = count_ > 0 ? ring_[first_].arrival : infinity;
    const double gone = acting_.arrival + longest_;
    if (time >= gone) return {Vec3::Zero(), next};
    return {acting_.force, std::min(next, gone)};
}

}  // namespace palpate::devices
