// The head phantom: ellipsoids painted one over the other, from the skin inwards.
#include "scenes/head_phantom.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::scenes {
namespace {

/// In units of half the box. Turned round z by the angle with this cosine and sine.
struct Ellipsoid {
    double centre[3];
    double axes[3];
    double cosine, sine;
    double hounsfield;
};

constexpr double air = -1000, skin = 60, bone = 1000, brain = 40, fluid = 8, lesion = 75, eye = 20;
constexpr double cos18 = 0.95105651629515357, sin18 = 0.30901699437494742;

constexpr std::array<Ellipsoid, 15> head{{
    {{0, -0.90, -0.14}, {0.10, 0.09, 0.16}, 1, 0, skin},  // nose
    {{0, 0, 0}, {0.74, 0.90, 0.90}, 1, 0, skin},
    {{0, 0, 0}, {0.66, 0.82, 0.82}, 1, 0, bone},
    {{0, 0.02, 0.02}, {0.57, 0.72, 0.71}, 1, 0, brain},
    {{0.25, -0.67, 0.02}, {0.13, 0.16, 0.12}, 1, 0, eye},
    {{-0.25, -0.67, 0.02}, {0.13, 0.16, 0.12}, 1, 0, eye},
    {{0.20, 0.02, 0.05}, {0.09, 0.27, 0.20}, cos18, sin18, fluid},    // ventricles
    {{-0.20, 0.02, 0.05}, {0.11, 0.33, 0.22}, cos18, -sin18, fluid},  //
    {{0, -0.32, 0.05}, {0.18, 0.20, 0.22}, 1, 0, lesion},
    {{0, -0.06, -0.25}, {0.05, 0.05, 0.05}, 1, 0, lesion},
    {{0, 0.12, -0.25}, {0.05, 0.05, 0.05}, 1, 0, lesion},
    {{-0.10, 0.55, 0}, {0.06, 0.04, 0.04}, 1, 0, lesion},
    {{0, 0.55, 0}, {0.04, 0.04, 0.04}, 1, 0, lesion},
    {{0.10, 0.55, 0}, {0.04, 0.06, 0.04}, 1, 0, lesion},
    {{0, 0.33, -0.42}, {0.20, 0.15, 0.12}, 1, 0, brain + 15},  // cerebellum
}};

/// How much of the point the ellipsoid covers: 1 inside, 0 outside, a ramp `edge` wide between.
/// The distance is the first-order one, k0 (k0 - 1) / k1: good near the surface, where it matters.
double coverage(const Ellipsoid& e, const Vec3& p, double edge) {
    const double x = p[0] - e.centre[0], y = p[1] - e.centre[1], z = p[2] - e.centre[2];
    const Vec3 q((e.cosine * x + e.sine * y) / e.axes[0], (e.cosine * y - e.sine * x) / e.axes[1],
                 z / e.axes[2]);
    const double thinnest = std::min({e.axes[0], e.axes[1], e.axes[2]});
    const double outermost = 1 + edge / thinnest;
    const double k0_squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    if (k0_squared > outermost * outermost) return 0;
    const double k0 = std::sqrt(k0_squared);
    const double k1 = Vec3(q[0] / e.axes[0], q[1] / e.axes[1], q[2] / e.axes[2]).norm();
    const double distance = k1 > 0 ? k0 * (k0 - 1) / k1 : -thinnest;
    return std::clamp(0.5 - distance / edge, 0.0, 1.0);
}

}  // namespace

double HeadPhantom::hounsfield(const Vec3& point) const {
    const Vec3 p = point / half_box_;
    if (p.squaredNorm() > 3) return air;
    double level = air;
    for (const Ellipsoid& e : head) {
        const double covered = coverage(e, p, edge_ / half_box_);
        if (covered > 0) level += covered * (e.hounsfield - level);
    }
    return level;
}

}  // namespace palpate::scenes
