// Stage 8, force: computes force and torque on the hand from hand and proxy (Corenthy et al. 2012,
// Eq. 4), with further effects and with limits. Lengths in device mm, angles in rad, forces in N,
// torques in N mm, time in s, vectors in device axes.
#pragma once

#include <cstdint>
#include <limits>

#include "palpate/tool.hpp"

namespace palpate {

/// Pulls a free hand to a near surface: 0 at the surface, `peak` halfway, 0 at `distance`.
struct Magnet {
    double distance = 0;  ///< [device mm] 0: off
    double peak = 0;      ///< [N]

    bool operator==(const Magnet&) const = default;
};

/// A bumpy surface by turning the contact force (bump mapping): a height field
/// a/2 (sin(2 pi x / w) + sin(2 pi y / w) + sin(2 pi z / w)) fixed in physical space. Every plane
/// has bumps. Across a coordinate axis they rise and fall by a.
struct Texture {
    double amplitude = 0;   ///< a [mm of physical space] 0: off
    double wavelength = 2;  ///< w [mm of physical space]

    bool operator==(const Texture&) const = default;
};

struct ForceSettings {
    double stiffness = 0.5;  ///< k [N/mm], Eq. 4: f = k (SCP - HIP)
    /// [N s/mm] against the hand's motion along the contact normal; at most cancels the force
    /// outwards, so it never pulls the hand in
    double damping = 0;
    double viscosity = 0;  ///< [N s/mm] of the medium, against all motion, in contact or not
    Magnet magnet;
    Texture texture;
    double limit = 3.3;         ///< [N] largest force. The device's own limit holds as well
    double rate_limit = 2000;   ///< [N/s] largest change of force. A stop may drop to zero at once
    double ramp = 0.25;         ///< [s] from zero to full force, at the start and after a pause
    double stale_after = 0.02;  ///< [s] a longer time between two device states is a pause
    /// [N] After a start, a pause or a release there is no force until the computed one is at most
    /// this, so that a hand that starts inside a solid is not thrown out. Infinity: do not wait.
    double start_below = std::numeric_limits<double>::infinity();

    // For a tool that turns.

    /// [N mm/rad] torque = this times the rotation from hand to proxy. 0: the stiffness times the
    /// square of the tool's gyration, with which the wrench equals that of the contacts.
    double rotational_stiffness = 0;
    /// [N mm s/rad] against the hand's turning out of equilibrium; at most cancels the torque
    double rotational_damping = 0;
    /// [N mm] largest torque. The device's own limit holds as well. 0: none.
    double torque_limit = std::numeric_limits<double>::infinity();
    double torque_rate_limit = 2e5;  ///< [N mm/s] as rate_limit

    bool operator==(const ForceSettings&) const = default;
};

/// The limits of a device.
struct DeviceLimits {
    double maximum_force = 3.3;  ///< [N] never exceeded (3.3: Omni, Touch)
    double rate = 1000;          ///< [Hz] of the servo loop
    /// [N s/mm] of device and hand, physical. A sampled spring k is passive for
    /// k (1 / (2 rate) + delay) + damping <= this (Colgate and Schenkel 1994, Hulin et al. 2014).
    /// 2.5 N s/m is a desktop device in a light grip.
    double physical_damping = 2.5e-3;
    double maximum_torque = 0;  ///< [N mm] never exceeded. 0: the device renders none
    /// [N mm s/rad] the same for rotation. 1 is `physical_damping` at a lever of 20 mm.
    double physical_rotational_damping = 1;
    /// [s] from the measurement of a position until its force acts: the delay of the device, of its
    /// exchange with the servo, and of rendering. The sampling is not included.
    double delay = 0;
    /// [N] the force that the motors can give for hours (warm_limit()). Infinity: their full force.
    double continuous_force = std::numeric_limits<double>::infinity();
    double warming_time = 60;  ///< [s] after which a constant force has warmed them to 63 %

    bool operator==(const DeviceLimits&) const = default;
};

/// Largest stiffness [N/mm] these limits can render with this damping [N s/mm].
double greatest_stiffness(const DeviceLimits& limits, double damping);
/// Rotational stiffness [N mm/rad] of the coupling to a tool of this gyration [device mm]. It is
/// set, or follows from the gyration, and is limited to the value that the device renders stably.
/// For a device without torque, it only serves to find the proxy's pose.
double rotational_stiffness(const ForceSettings& settings, const DeviceLimits& limits,
                            double gyration);
/// The smaller of both, number by number, but the larger delay. A number that is negative or NaN
/// counts as 0, a delay as infinite: no force.
DeviceLimits smaller(const DeviceLimits& one, const DeviceLimits& other) noexcept;
/// The settings as these limits can render them stably. Settings that pass check() come back as
/// they are. Otherwise one factor lowers stiffness, damping and viscosity, which keeps their
/// proportions. Another factor lowers stiffness and damping of rotation. The magnet's peak is
/// lowered as far as needed. `limit` stays: render_force() takes the smaller of the two.
ForceSettings stable(ForceSettings settings, const DeviceLimits& limits) noexcept;

/// Throws std::invalid_argument, naming the limit, its value and the accepted range, for limits
/// that no device has.
void check(const DeviceLimits& limits);
/// Throws std::invalid_argument, naming the setting, its value and the accepted range, for numbers
/// that are NaN, negative or cannot be rendered stably.
void check(const ForceSettings& settings, const DeviceLimits& limits);

/// Input of the force stage in one tick.
struct ForceInput {
    double time = 0;      ///< [s], strictly increasing
    bool valid = true;    ///< false: the device's input is stale or broken
    bool enabled = true;  ///< false: forces off by the user
    /// True: the force falls to zero within the rate limit, and starts again (start_below, ramp)
    /// once this is false.
    bool released = false;
    bool constrained = false;
    Vec3 hand = Vec3::Zero();           ///< device position [device mm]
    Vec3 pull = Vec3::Zero();           ///< SCP - HIP [device mm]
    Vec3 normal = Vec3::Zero();         ///< free: unit, from the nearest surface to the SCP
    double surface_distance = -1;       ///< free: [device mm] to that surface; < 0: there is none
    Vec3 texture_slope = Vec3::Zero();  ///< gradient of the texture's height at the SCP
    double rotational_stiffness = 0;    ///< [N mm/rad] 0: nothing turns, so there is no torque
    Quaternion orientation = Quaternion::Identity();  ///< of the hand
    Vec3 turn = Vec3::Zero();                         ///< rotation from hand to proxy [rad]
};

/// Bits: the reasons for which a force differs from the one that follows from the settings alone.
enum ForceFlag : std::uint16_t {
    force_limited = 1,       ///< cut to the maximum
    force_rate_limited = 2,  ///< change of force cut
    force_ramping = 4,       ///< in the ramp after a start, a pause or a change
    force_stale = 8,         ///< input stale, invalid or going back in time: zero
    force_not_finite = 16,   ///< some number was NaN or infinite: zero
    force_off = 32,          ///< switched off: zero
    force_waiting = 64,      ///< released, or waiting for a small force to start with
    force_overrun = 128,     ///< the tick took too long: zero
    force_warm = 256,        ///< cut because the motors are warm (warm_limit())
};

/// How warm the motors are, estimated from the forces that they were given. A constant force f
/// warms them towards (f / continuous_force)^2 as 1 - exp(-t / warming_time): they are one body,
/// and their power is the square of their current.
struct MotorHeat {
    double warmth = 0;  ///< 0: room temperature, 1: the temperature with the continuous force
    double time = 0;    ///< [s] of the warmth
    double force = 0;   ///< [N] that acts since then
};
/// The same at a later time [s]. A force acts for at most `held` [s]. A time that is not finite
/// changes nothing. The step is implicit: it is stable for every time, and after a pause never
/// gives too little warmth.
MotorHeat warmed(MotorHeat heat, const DeviceLimits& limits, double time, double held) noexcept;
/// The largest force [N] for motors of this warmth: the maximum up to a warmth of 0.7, then less,
/// down to the continuous force at 1. So the warmth does not exceed 1 while a tick adds little to
/// it, as with every device in devices/models.cpp.
double warm_limit(const DeviceLimits& limits, const MotorHeat& heat) noexcept;

/// State between ticks.
struct ForceState {
    bool started = false;
    bool waiting = true;  ///< for a small enough force to start with
    /// To be set with every change of the contact that is not the hand's motion, for example of a
    /// level, of samples or settings. In the next tick, springs then rise no faster than by the
    /// hand's motion and the ramp.
    bool changed = false;
    double time = 0;               ///< [s] of the last tick
    double ramp_begin = 0;         ///< [s]
    Vec3 hand = Vec3::Zero();      ///< [device mm]
    Vec3 velocity = Vec3::Zero();  ///< [device mm/s], low-pass filtered; at most 10 m/s counts
    Vec3 force = Vec3::Zero();     ///< [N] as rendered
    double spring = 0;             ///< [N] the part of it that spring or magnet gave
    bool turns = false;            ///< the next members are known
    Quaternion orientation = Quaternion::Identity();
    Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s], low-pass filtered; at most 100 rad/s counts
    Vec3 torque = Vec3::Zero();            ///< [N mm] as rendered
    double turning_spring = 0;             ///< [N mm] the part of it that the spring gave
    MotorHeat motors;                      ///< kept by every stop
};
/// No force, and the ramp begins again. The motors stay as warm as they are.
void restart(ForceState& state) noexcept;

struct ForceResult {
    Vec3 force = Vec3::Zero();   ///< [N], device axes
    Vec3 torque = Vec3::Zero();  ///< [N mm], device axes, about the tool's reference point
    std::uint16_t flags = 0;     ///< ForceFlag bits
};

/// Force and torque of one tick. Never throws. Input that is not valid gives zero at once, and the
/// ramp starts again. After a change (ForceState::changed) the ramp goes on from where the force
/// was. Even settings that check() would refuse give no force beyond `limits`. Warm motors lower
/// the maximum (warm_limit()). A lowered limit holds at once: that fall, and every stop, is exempt
/// from the rate limit.
ForceResult render_force(ForceState& state, const ForceSettings& settings,
                         const DeviceLimits& limits, const ForceInput& input);

/// Gradient of the texture's height at a physical point [mm/mm], physical axes.
Vec3 texture_slope(const Texture& texture, const Vec3& physical);

}  // namespace palpate
