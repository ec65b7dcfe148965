// Properties of the simulated devices and hands. Which are published and which assumed is said in
// docs/devices/simulated.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate::devices {

/// A haptic device as a rigid body at the grip, the same in all directions and about all axes.
struct DeviceProfile {
    std::string name;             ///< for the option `profile`
    std::string model;            ///< as people call it
    double mass = 0.05;           ///< [kg] apparent at the grip, > 0
    double damping = 0;           ///< [N s/mm] viscous, of the mechanics
    double friction = 0;          ///< [N] Coulomb, static and sliding alike
    double encoder_step = 0;      ///< [mm] positions are read in multiples of it; 0: exactly
    double maximum_force = 0;     ///< [N]
    double continuous_force = 0;  ///< [N] for hours
    double force_step = 0;        ///< [N] the motors' command has multiples of it; 0: any
    double delay = 0;             ///< [s] from writing a force until it acts
    double stiffness = 0;         ///< [N/mm] it is rated for
    bool jitter = false;          ///< its own servo runs at the times of ServoTicks
    Vec3 workspace_low = Vec3::Zero();
    Vec3 workspace_high = Vec3::Zero();  ///< [device mm]

    // Of rotation.

    bool has_orientation = false;    ///< false: nothing below counts
    double inertia = 1;              ///< [kg mm^2] apparent at the grip, > 0
    double rotational_damping = 0;   ///< [N mm s/rad] viscous, of the mechanics
    double rotational_friction = 0;  ///< [N mm] Coulomb
    double angle_step = 0;           ///< [rad] orientations are read in multiples of it; 0: exactly
    double maximum_torque = 0;       ///< [N mm] 0: it measures the orientation only
    double torque_step = 0;          ///< [N mm] as force_step
};

/// omni, touch, touchx, omega3, omega6, omega7, sigma7, premium6dof, falcon, inverse3,
/// inverse3_versegrip.
const std::vector<std::string>& profile_names();
/// Throws std::invalid_argument, listing the names, for another.
const DeviceProfile& profile(std::string_view name);

/// The hand at the grip: a mass that moves with the device, and a spring and a damper towards the
/// hand's target; the same of rotation.
struct HandGrip {
    double mass = 0;                  ///< [kg]
    double damping = 0;               ///< [N s/mm]
    double stiffness = 0;             ///< [N/mm]
    double inertia = 0;               ///< [kg mm^2]
    double rotational_damping = 0;    ///< [N mm s/rad]
    double rotational_stiffness = 0;  ///< [N mm/rad]
};

/// light, normal, firm.
const std::vector<std::string>& grip_names();
/// Throws std::invalid_argument, listing the names, for another.
const HandGrip& grip(std::string_view name);

}  // namespace palpate::devices
