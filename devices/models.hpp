// The abilities of haptic devices, by their data sheets: one table for the backends and for the
// simulated devices. docs/devices/models.md gives the sources.
#pragma once

#include <string_view>

namespace palpate::devices {

struct Model {
    const char* name;
    double force;                 ///< [N]
    double stiffness;             ///< [N/mm] it is rated for
    double width, height, depth;  ///< [mm] of the usable box
    bool has_wrist = false;       ///< measures the orientation
    bool has_gripper = false;
    double torque = 0;  ///< [N mm] of the wrist's motors; 0: none
};

/// Throws std::invalid_argument for a name that is not in the table.
const Model& model_named(std::string_view name);

}  // namespace palpate::devices
