// Makes a layer for tests from the properties that they examine.
#pragma once

#include <string>

#include "palpate/layers.hpp"

namespace palpate::support {

/// Its stiffness [N/mm] and puncture force [N]; the rest is as usual.
inline Layer layer_of(const std::string& name, double level, double stiffness, double force) {
    Layer made;
    made.name = name;
    made.level = level;
    made[HapticProperty::stiffness] = stiffness;
    made[HapticProperty::puncture_force] = force;
    return made;
}

}  // namespace palpate::support
