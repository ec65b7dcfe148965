// Hand, proxy, spring and force as markers in a scene, sized for its picture.
#pragma once

#include <optional>

#include "pictures/scene.hpp"

namespace palpate::pictures {

struct Contact {
    std::optional<Vec3> scp, hip;  ///< [mm, physical]
    std::optional<Vec3> force;     ///< [N] on the hand, physical axes; drawn from the SCP (or HIP)
};

/// Adds them with their labels. The camera must be directed (frame()) before.
void add_contact(PictureScene& scene, const Contact& contact);

/// Radius [mm] of a line that is `pixels` wide in this picture.
double line_radius(const PictureScene& scene, double pixels);

}  // namespace palpate::pictures
