// Force: spring, damping, viscosity, magnet and texture, and the limits. See docs/force.md.
#include "palpate/force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace palpate {
namespace {

/// Time constant of the velocity filter [s]: a 100 Hz low pass. Unfiltered, one encoder step of
/// 0.05 mm at 1 kHz reads as 50 mm/s.
constexpr double velocity_filter = 1 / (2 * std::numbers::pi * 100);
/// Greatest velocity that counts [mm/s]. What measures faster is a glitch; without this bound one
/// false position would keep the filtered velocity high for tens of ticks.
constexpr double fastest_hand = 1e4;
constexpr double fastest_turn = 100;  // [rad/s] the same
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double warm = 0.7;         // MotorHeat::warmth from which on the force is limited
constexpr double most_power = 1e12;  // of the continuous force's: keeps the warmth finite

ForceResult stop(ForceState& state, std::uint16_t why) {
    restart(state);
    return {Vec3::Zero(), Vec3::Zero(), why};
}

/// The start, or the first tick after a pause: the ramp begins here, from zero.
void begin(ForceState& state, const ForceInput& input) {
    restart(state);
    state.started = true;
    state.time = state.ramp_begin = input.time;
    state.hand = input.hand;
}

/// The contact force: the spring, turned by the texture, damped along the normal but never pulling
/// the hand in.
Vec3 contact_force(const ForceSettings& settings, const ForceInput& input, const Vec3& velocity,
                   double part) {
    Vec3 force = part * settings.stiffness * input.pull;
    const double strength = force.norm();
    if (strength == 0) return force;
    const Vec3 outward = force / strength;
    const Vec3 slope = input.texture_slope - outward * outward.dot(input.texture_slope);
    if (!slope.isZero(0)) force = strength * (outward - slope).normalized();
    // Damping at most cancels the force outwards, which is less than `strength` if it was turned.
    const double into = -velocity.dot(outward);
    return force + outward * std::max(settings.damping * into, -force.dot(outward));
}

Vec3 magnet_force(const Magnet& magnet, const ForceInput& input) {
    const double d = input.surface_distance;
    if (!(d > 0 && d < magnet.distance)) return Vec3::Zero();
    const double along = d / magnet.distance;
    return -input.normal * (magnet.peak * 4 * along * (1 - along));
}

/// The spring of rotation, damped but never turning the hand further out of equilibrium.
Vec3 contact_torque(const ForceSettings& settings, const ForceInput& input,
                    const Vec3& angular_velocity, double part) {
    Vec3 torque = part * input.rotational_stiffness * input.turn;
    const double strength = torque.norm();
    if (strength == 0) return torque;
    const Vec3 axis = torque / strength;
    const double against = -settings.rotational_damping * angular_velocity.dot(axis);
    return torque + axis * std::max(against, -strength);
}

/// The smaller of what is set and what the device takes. A setting that is NaN or negative, which
/// check() refuses, counts as 0.
double most_of(double limit, double maximum) {
    const double least = std::min(limit, maximum);
    return least > 0 && maximum > 0 ? least : 0;
}

/// Limits of a force or a torque.
struct Bounds {
    double most;
    double rate;  // a second
    double ramp;  // share of it, at most 1
};

/// The part of a tool's two springs that keeps both within their limits: one for both, of the
/// energy alone, so that the wrench stays the gradient of a potential (docs/force.md).
/// `most_torque`: infinity where no torque is rendered.
double part_of_springs(double stiffness, double most_force, double most_torque,
                       const ForceInput& input) {
    const double turning = input.rotational_stiffness;
    if (!(turning > 0) || !input.constrained) return 1;
    const double twice_energy =
        stiffness * input.pull.squaredNorm() + turning * input.turn.squaredNorm();
    const double force = std::sqrt(stiffness * twice_energy);
    const double torque = std::sqrt(turning * twice_energy);
    if (!std::isfinite(force + torque)) return std::numeric_limits<double>::quiet_NaN();
    double part = 1;
    if (force > most_force) part = most_force / force;
    if (torque > most_torque) part = std::min(part, most_torque / torque);
    return part;
}

/// The maximum, the ramp and the rate. A setting that is NaN or negative, which check() refuses,
/// gives no force or a NaN that the caller catches, never a larger force.
Vec3 within(Vec3 force, const Vec3& before, const Bounds& bounds, double step,
            std::uint16_t& flags) {
    if (force.norm() > bounds.most) {
        force *= bounds.most / force.norm();
        flags |= force_limited;
    }
    if (!(bounds.ramp >= 1)) {
        force *= bounds.ramp;
        flags |= force_ramping;
    }
    const Vec3 change = force - before;
    const double most_change = std::isfinite(bounds.rate) ? bounds.rate * step : bounds.rate;
    if (!(change.norm() <= most_change)) {
        force = before + change * (std::max(most_change, 0.0) / change.norm());
        flags |= force_rate_limited;
    }
    // Again, because the rate limit keeps a force above a limit that has just been lowered.
    if (force.norm() > bounds.most) force *= bounds.most / force.norm();
    return force;
}

/// A spring of translation [N] or rotation [N mm], or a magnet.
struct SpringForce {
    double now;      // its force, within the limit
    double by_hand;  // the most that the hand's motion since the last tick can have added
    double before;   // its force in the last tick
    double most;     // its limit

    /// The part of it that acts at once if something other than the hand changed it. `ramp`: a tick
    /// as a part of the ramp.
    double part_at_once(double ramp) const {
        const double at_once = before + by_hand + most * ramp;
        return now > at_once ? at_once / now : 1;
    }
};

/// Greatest change of the force per length of the hand's way [N/mm].
double steepest(const ForceSettings& settings) {
    const Magnet& magnet = settings.magnet;
    return std::max(settings.stiffness,
                    magnet.distance > 0 ? 4 * magnet.peak / magnet.distance : 0.0);
}

SpringForce spring_of(const ForceState& state, const ForceSettings& settings,
                      const ForceInput& input, double part, double most) {
    const double now = input.constrained ? part * settings.stiffness * input.pull.norm()
                                         : magnet_force(settings.magnet, input).norm();
    return {std::min(now, most), steepest(settings) * (input.hand - state.hand).norm(),
            state.spring, most};
}

SpringForce turning_spring_of(const ForceState& state, const ForceInput& input, double part,
                              double most) {
    const double stiffness = input.constrained ? input.rotational_stiffness : 0;
    const double way =
        state.turns ? rotation_between(state.orientation, input.orientation).norm() : 0;
    return {std::min(part * stiffness * input.turn.norm(), most), stiffness * way,
            state.turning_spring, most};
}

/// The part of the ramp at this time. After a change the ramp continues from the part with which
/// the springs give as much as before. `step` is the time since the last tick [s].
double part_of_ramp(ForceState& state, double ramp, double time, double step,
                    const SpringForce& spring, const SpringForce& turning) {
    const double since = time - state.ramp_begin;
    const double part = since >= ramp ? 1 : since / ramp;
    if (!std::exchange(state.changed, false)) return part;
    const double at_once =
        std::min(spring.part_at_once(step / ramp), turning.part_at_once(step / ramp));
    if (!(at_once < part)) return part;
    state.ramp_begin = time - at_once * ramp;
    return at_once;
}

/// Filters a velocity; `step` is the time since the last tick [s].
void filter(Vec3& velocity, const Vec3& way, double step, double fastest) {
    Vec3 measured = way / step;
    const double speed = measured.stableNorm();
    if (!(speed <= fastest)) {
        measured = std::isfinite(speed) ? Vec3(measured * (fastest / speed)) : Vec3::Zero();
    }
    velocity += (measured - velocity) * (step / (step + velocity_filter));
}

void update_velocities(ForceState& state, const ForceInput& input, double step) {
    filter(state.velocity, input.hand - state.hand, step, fastest_hand);
    if (!(input.rotational_stiffness > 0) || !state.turns) return;
    const Vec3 way = rotation_between(state.orientation, input.orientation);
    filter(state.angular_velocity, way, step, fastest_turn);
}

bool is_finite(const ForceInput& input) {
    return std::isfinite(input.time) && input.hand.allFinite() && input.pull.allFinite() &&
           input.turn.allFinite() && input.orientation.coeffs().allFinite();
}

/// [1/s] A spring k is passive for k / this + damping <= physical damping.
double passive_rate(const DeviceLimits& limits) {
    return 2 * limits.rate / (1 + 2 * limits.rate * limits.delay);
}

/// The largest k with this damping.
double passive_stiffness(double rate, double physical_damping, double damping) {
    return std::max(0.0, rate * (physical_damping - damping));
}

/// One factor <= 1 for a spring and its dampers, with which that holds: 1, or by more than
/// rounding.
double stable_part(double stiffness, double damping, double rate, double physical_damping) {
    if (damping < physical_damping &&
        stiffness <= passive_stiffness(rate, physical_damping, damping)) {
        return 1;
    }
    const double used = stiffness / rate + damping;
    const double part = physical_damping / used * (1 - 1e-9);
    return part > 0 && part < 1 ? part : 0;
}

}  // namespace

double greatest_stiffness(const DeviceLimits& limits, double damping) {
    return passive_stiffness(passive_rate(limits), limits.physical_damping, damping);
}

double rotational_stiffness(const ForceSettings& s, const DeviceLimits& limits, double gyration) {
    const double wanted =
        s.rotational_stiffness > 0 ? s.rotational_stiffness : s.stiffness * gyration * gyration;
    if (!(limits.maximum_torque > 0)) return wanted;
    return std::min(wanted,
                    passive_stiffness(passive_rate(limits), limits.physical_rotational_damping,
                                      s.rotational_damping));
}

DeviceLimits smaller(const DeviceLimits& one, const DeviceLimits& other) noexcept {
    const auto least = [](double a, double b) { return a >= 0 && b >= 0 ? std::min(a, b) : 0.0; };
    const bool are_delays = one.delay >= 0 && other.delay >= 0;
    return {least(one.maximum_force, other.maximum_force),
            least(one.rate, other.rate),
            least(one.physical_damping, other.physical_damping),
            least(one.maximum_torque, other.maximum_torque),
            least(one.physical_rotational_damping, other.physical_rotational_damping),
            are_delays ? std::max(one.delay, other.delay) : infinity,
            least(one.continuous_force, other.continuous_force),
            least(one.warming_time, other.warming_time)};
}

MotorHeat warmed(MotorHeat heat, const DeviceLimits& limits, double time, double held) noexcept {
    if (!std::isfinite(time)) return heat;
    const double passed = time - heat.time;
    const auto add = [&](double power, double seconds) {
        const double all = limits.warming_time + seconds;
        heat.warmth = all > 0 ? (limits.warming_time * heat.warmth + seconds * power) / all : power;
    };
    if (passed > 0) {
        const double ratio = heat.force > 0 ? heat.force / limits.continuous_force : 0;
        const double acting = std::min(passed, held);
        add(std::min(ratio * ratio, most_power), acting);
        if (passed > acting) add(0, passed - acting);
    }
    heat.time = time;
    return heat;
}

double warm_limit(const DeviceLimits& limits, const MotorHeat& heat) noexcept {
    if (!(heat.warmth > warm)) return limits.maximum_force;
    const double continuous = std::min(limits.continuous_force, limits.maximum_force);
    const double cold = std::max(0.0, (1 - heat.warmth) / (1 - warm));
    return continuous + cold * (limits.maximum_force - continuous);
}

void restart(ForceState& state) noexcept {
    const MotorHeat motors{state.motors.warmth, state.motors.time, 0};
    state = ForceState{};
    state.motors = motors;
}

ForceSettings stable(ForceSettings s, const DeviceLimits& limits) noexcept {
    const double rate = passive_rate(limits);
    const double part =
        stable_part(s.stiffness, s.damping + s.viscosity, rate, limits.physical_damping);
    s.stiffness *= part;
    s.damping *= part;
    s.viscosity *= part;
    const double turning = stable_part(s.rotational_stiffness, s.rotational_damping, rate,
                                       limits.physical_rotational_damping);
    s.rotational_stiffness *= turning;
    s.rotational_damping *= turning;
    const double peak = greatest_stiffness(limits, s.damping + s.viscosity) * s.magnet.distance / 4;
    if (s.magnet.distance > 0 && !(s.magnet.peak <= peak)) s.magnet.peak = peak;
    return s;
}

static void keep(ForceState& state, const ForceInput& input, const Vec3& force,
                 const Vec3& torque) {
    state.time = input.time;
    state.hand = input.hand;
    state.force = force;
    state.motors.force = force.norm();
    state.turns = input.rotational_stiffness > 0;
    state.orientation = input.orientation;
    state.torque = torque;
}

/// From a release until the force is small again. Then the ramp begins.
static bool waits(ForceState& state, const ForceInput& input, bool is_strong) {
    state.waiting |= input.released;
    if (!state.waiting) return false;
    state.ramp_begin = input.time;
    state.waiting = input.released || is_strong;
    return state.waiting;
}

ForceResult render_force(ForceState& state, const ForceSettings& settings,
                         const DeviceLimits& limits, const ForceInput& input) {
    state.motors = warmed(state.motors, limits, input.time, settings.stale_after);
    if (!input.enabled) return stop(state, force_off);
    if (!input.valid) return stop(state, force_stale);
    if (!is_finite(input)) return stop(state, force_not_finite);
    double step = input.time - state.time;
    std::uint16_t flags = 0;
    if (!state.started || !(step <= settings.stale_after)) {
        if (state.started) flags |= force_stale;
        begin(state, input);
        step = 0;
    } else if (!(step > 0)) {
        return stop(state, force_stale);
    } else {
        update_velocities(state, input, step);
    }
    const bool turns = input.rotational_stiffness > 0 && limits.maximum_torque > 0;
    const double spared = warm_limit(limits, state.motors);
    const double most_force = most_of(settings.limit, spared);
    const double most_torque = turns ? most_of(settings.torque_limit, limits.maximum_torque)
                                     : std::numeric_limits<double>::infinity();
    const double part = part_of_springs(settings.stiffness, most_force, most_torque, input);
    if (part < 1) flags |= force_limited;
    Vec3 force = input.constrained ? contact_force(settings, input, state.velocity, part)
                                   : magnet_force(settings.magnet, input);
    force -= settings.viscosity * state.velocity;
    Vec3 torque = Vec3::Zero();
    if (turns && input.constrained) {
        torque = contact_torque(settings, input, state.angular_velocity, part);
    }
    // A force whose square overflows has neither a length nor a direction.
    if (!std::isfinite(force.squaredNorm()) || !std::isfinite(torque.squaredNorm())) {
        return stop(state, force_not_finite);
    }
    SpringForce spring = spring_of(state, settings, input, part, most_force);
    SpringForce turning = turning_spring_of(state, input, turns ? part : 0, most_torque);
    // The force without a limit decides.
    const bool strong = part > 0 && !(force.norm() <= part * settings.start_below);
    if (waits(state, input, strong)) {
        force.setZero();
        torque.setZero();
        spring.now = turning.now = 0;
        flags |= force_waiting;
    }
    const double ramp = part_of_ramp(state, settings.ramp, input.time, step, spring, turning);
    const Bounds of_force{most_force, settings.rate_limit, ramp};
    const Bounds of_torque{most_torque, settings.torque_rate_limit, ramp};
    force = within(force, state.force, of_force, step, flags);
    const bool is_warm = spared < std::min(settings.limit, limits.maximum_force);
    if (is_warm && !(force.norm() < spared * (1 - 1e-9))) flags |= force_warm;
    if (turns) torque = within(torque, state.torque, of_torque, step, flags);
    if (!force.allFinite() || !torque.allFinite()) return stop(state, force_not_finite);
    keep(state, input, force, torque);
    state.spring = ramp * spring.now;
    state.turning_spring = ramp * turning.now;
    return {force, torque, flags};
}

Vec3 texture_slope(const Texture& texture, const Vec3& p) {
    if (texture.amplitude == 0) return Vec3::Zero();
    const double w = 2 * std::numbers::pi / texture.wavelength;
    return texture.amplitude * w / 2 * (w * p).array().cos();
}

}  // namespace palpate
