// The abilities of haptic devices, by their data sheets: one table for the backends and for the
// simulated devices. docs/devices/models.md gives the sources.
#pragma once

#include <string_view>

#include "palpate/force.hpp"

namespace palpate::devices {

struct Model {
    const char* name;
    double force;                 ///< [N]
    double continuous;            ///< [N] for hours
    double stiffness;             ///< [N/mm] it is rated for
    double delay;                 ///< [ms] from a measurement until a force acts, of itself
    double width, height, depth;  ///< [mm] of the usable box
    bool has_wrist = false;       ///< measures the orientation
    bool has_gripper = false;
    double torque = 0;  ///< [N mm] of the wrist's motors; 0: none
};

/// Throws std::invalid_argument for a name that is not in the table.
const Model& model_named(std::string_view name);

/// What this model can take. `exchange` [s]: what the way through its thread adds to its delay
/// (exchange_delay()).
DeviceLimits limits_of(const Model& model, double rate, double exchange);

}  // namespace palpate::devices
