// The spring of layers without surfaces, after penetrability.
#pragma once

#include "palpate/layers.hpp"

namespace palpate {

/// Penetrability may have moved the SCP. The spring's rest length stays, so that no energy is
/// gained. `scale`: physical mm per device mm.
inline void stretch_again(ContactSpring& spring, const ProxyUpdate& at, double scale,
                          LayersUpdate& layers) noexcept {
    layers.pulls = pulls(at);
    layers.pull.setZero();
    spring.touching &= layers.pulls;
    if (!layers.pulls) return;
    const Vec3 stretch = (at.scp - at.hip) / scale;
    const double distance = stretch.norm(), stiffness = layers.force.stiffness;
    const double force = spring.move(distance, stiffness);
    if (force > 0) layers.pull = stretch * (force / (stiffness * distance));
}

}  // namespace palpate
