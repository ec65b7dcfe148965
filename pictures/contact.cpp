// Adds the markers of a contact to a scene.
#include "pictures/contact.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace palpate::pictures {
namespace {

std::string in_newtons(double force) {
    char text[32];
    std::snprintf(text, sizeof text, "force %.3g N", force);
    return text;
}

}  // namespace

double line_radius(const PictureScene& scene, double pixels) {
    return pixels * scene.camera.half_height / scene.height;
}

void add_contact(PictureScene& scene, const Contact& contact) {
    const double height = 2 * scene.camera.half_height;  // [mm] of the picture
    const double radius = 0.011 * height;
    const auto& [scp, hip, force] = contact;
    if (scp && hip && *scp == *hip) {
        scene.balls.push_back({*hip, radius, hip_colour, "hand (HIP) and proxy (SCP), free"});
        return;
    }
    if (scp) scene.balls.push_back({*scp, radius, scp_colour, "proxy (SCP)"});
    if (hip) scene.balls.push_back({*hip, radius, hip_colour, "hand (HIP)"});
    if (scp && hip && (*scp - *hip).norm() > 2 * radius) {
        scene.springs.push_back({*hip, *scp, 0.5 * radius, spring_colour, ""});
    }
    const std::optional<Vec3>& root = scp ? scp : hip;
    if (force && root && force->norm() > 0) {
        // A newton is an eighth of the picture, within what can be seen and fits.
        const double length = std::clamp(0.125 * force->norm(), 0.07, 0.3) * height;
        scene.arrows.push_back({*root, *root + length * force->normalized(), 0.35 * radius,
                                force_colour, in_newtons(force->norm())});
    }
}

}  // namespace palpate::pictures
