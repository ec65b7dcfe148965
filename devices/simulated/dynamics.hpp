// The physics of a simulated device in a hand, as plain values: no clock, no Device. Lengths in
// device mm, angles in rad, forces in N, torques in N mm, time in s, masses in kg.
#pragma once

#include <cstddef>
#include <vector>

#include "devices/simulated/profiles.hpp"
#include "palpate/tool.hpp"

namespace palpate::devices {

/// A hand that holds a device: one mass on a damper (the device's), with Coulomb friction, and on a
/// spring and a damper to a target (the hand's):
///   M x'' = F - B x' - friction - b (x' - target') - k (x - target)
/// All numbers >= 0, and mass > 0.
struct HandAndDevice {
    double mass = 0.1;             ///< M [kg] of both
    double damping = 0;            ///< B [N s/mm] of the device
    double friction = 0;           ///< [N] static and sliding alike, against the motion
    double hand_damping = 0;       ///< b [N s/mm]
    double hand_stiffness = 0;     ///< k [N/mm]
    Vec3 position = Vec3::Zero();  ///< [mm]
    Vec3 velocity = Vec3::Zero();  ///< [mm/s]
};

/// At rest there.
HandAndDevice hand_and_device(const DeviceProfile& device, const HandGrip& hand,
                              const Vec3& position);

/// The same of rotation, about the grip: an inertia J (the same about all axes, so no axis has a
/// part in the motion about another),
///   J w' = T - B w - friction - b (w - w_target) - k (rotation from the target to it)
/// All numbers >= 0, and inertia > 0. Translation and rotation do not act on each other.
struct TurningHandAndDevice {
    double inertia = 1;                               ///< J [kg mm^2] of both
    double damping = 0;                               ///< B [N mm s/rad] of the device
    double friction = 0;                              ///< [N mm]
    double hand_damping = 0;                          ///< b [N mm s/rad]
    double hand_stiffness = 0;                        ///< k [N mm/rad]
    Quaternion orientation = Quaternion::Identity();  ///< handle axes to device axes
    Vec3 velocity = Vec3::Zero();                     ///< [rad/s]
};

/// At rest, so.
TurningHandAndDevice turning_hand_and_device(const DeviceProfile& device, const HandGrip& hand,
                                             const Quaternion& orientation);

/// One step of dt [s] under the force that the motors give [N], with the target and its velocity
/// [mm/s] as they are at the end of the step.
///
/// Implicit Euler, the friction included (a set-valued force has one solution at the end of the
/// step): stable for every step and every parameter, never adds energy, and what friction stops
/// stands still exactly. First order: what is to be accurate takes steps of at most
/// `longest_step`.
void advance(HandAndDevice& system, const Vec3& target, const Vec3& target_velocity,
             const Vec3& motor_force, double dt) noexcept;
/// The same under the motors' torque [N mm] and a target's orientation and velocity [rad/s].
void advance(TurningHandAndDevice& system, const Quaternion& target, const Vec3& target_velocity,
             const Vec3& motor_torque, double dt) noexcept;

/// [s] 40 kHz. The stiffest hand allowed (100 N/mm) on the lightest device here oscillates once in
/// 168 of them.
inline constexpr double longest_step = 25e-6;

/// The force the motors produce for a commanded one: at most the maximum, in whole force steps, and
/// zero for a force that is not finite.
Vec3 motor_force(const DeviceProfile& device, const Vec3& commanded) noexcept;

/// The same for a torque.
Vec3 motor_torque(const DeviceProfile& device, const Vec3& commanded) noexcept;

/// Where the encoders say the device is.
Vec3 encoder_position(const DeviceProfile& device, const Vec3& position) noexcept;

/// How they say it is turned: the rotation vector (axis times angle) in whole steps.
Quaternion encoder_orientation(const DeviceProfile& device, const Quaternion& orientation) noexcept;

/// Wrenches on their way to the motors: each acts `delay` [s] after it was sent, until the next
/// one, but for no longer than `longest` [s]. Allocates in its constructor only.
class WrenchLine {
  public:
    /// `room` wrenches may be under way; when more are, the newest replaces the one before.
    WrenchLine(double delay, double longest, std::size_t room);

    /// Times must not decrease; one that does counts as the last one.
    void send(const Wrench& wrench, double time) noexcept;

    struct Acting {
        Wrench wrench;
        double until = 0;  ///< [s] it does not change before; later than the time asked for
    };
    /// What acts at a time. Times must not decrease.
    Acting at(double time) noexcept;

  private:
    struct Command {
        Wrench wrench;
        double arrival = 0;
    };
    double delay_, longest_;
    std::vector<Command> ring_;
    std::size_t first_ = 0, count_ = 0;
    double last_arrival_;
    Command acting_;
};

}  // namespace palpate::devices
