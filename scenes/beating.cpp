// The scene `beating`: two ellipsoids with walls, how they contract, and how they join.
#include "palpate/scenes/beating.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/fill.hpp"

namespace palpate::scenes {
namespace {

/// How far the muscle is drawn together, 0..1; smooth and of period 1, quicker in than out.
double contraction(double phase) {
    constexpr double turn = 2 * std::numbers::pi;
    const double skewed = turn * phase + 0.6 * std::sin(turn * phase);
    return 0.5 - 0.5 * std::cos(skewed);
}

/// A chamber: an ellipsoid, the middle of a wall. Lengths are parts of the cube's.
struct Chamber {
    Vec3 centre, axes;
    double reach;  ///< from the wall's middle to where its density is 0
};

/// Contracted: narrower and a little shorter, its base drawn to the apex, its wall thicker.
Chamber contracted(Chamber chamber, double part) {
    chamber.axes =
        chamber.axes.cwiseProduct(Vec3(1 - 0.24 * part, 1 - 0.24 * part, 1 - 0.12 * part));
    chamber.centre[2] -= 0.03 * part;
    chamber.reach *= 1 + 0.35 * part;
    return chamber;
}

/// How far a point lies outside the wall's middle, nearly; negative inside.
double distance(const Chamber& chamber, const Vec3& p) {
    const Vec3 q = (p - chamber.centre).cwiseQuotient(chamber.axes);
    const double k = q.norm();
    const double slope = q.cwiseQuotient(chamber.axes).norm();
    // At the centre itself there is no slope; nearest is the shortest axis.
    return slope > 1e-9 ? k * (k - 1) / slope : -chamber.axes.minCoeff();
}

double wall(double distance, double reach) {
    return std::max(0.0, 1 - std::abs(distance) / reach);
}

}  // namespace

double beating_density(const Vec3& point, double phase, double length) {
    // The left chamber, and the right one, which lies against it and follows a little later.
    const Chamber left =
        contracted({Vec3(0.13, 0.01, 0), Vec3(0.20, 0.20, 0.31), 0.07}, contraction(phase));
    const Chamber right = contracted({Vec3(-0.15, -0.02, 0.03), Vec3(0.21, 0.23, 0.27), 0.05},
                                     contraction(phase - 0.04));
    const Vec3 p = point / length;
    const double to_left = distance(left, p);
    const double a = wall(to_left, left.reach);
    double b = wall(distance(right, p), right.reach);
    // The left chamber is round, the right one ends at its wall.
    const double outside = std::clamp(1 + to_left / left.reach, 0.0, 1.0);
    b *= outside * outside * (3 - 2 * outside);
    return a + b - a * b;
}

Geometry beating_grid(const Index3& size) {
    return centred(size, Vec3::Constant(beating_length / size.maxCoeff()));
}

Scene beating_frame(const Geometry& geometry, double phase, SampleType type,
                    const OnProgress& progress) {
    const Scale scale = unit_scale(type);
    const double length = shortest_length(geometry);
    const auto value = [=](const Vec3& p) { return scale(beating_density(p, phase, length)); };
    return {"beating", filled(geometry, type, value, progress), scale(0.5),
            "a heart-like shell of two chambers, 20 frames in a beat of 0.8 s",
            [=, centre = physical_centre(geometry)](const Vec3& physical) {
                return value(grid_axes_from_physical(geometry, physical - centre));
            }};
}

Scene beating_frame(const Index3& size, double phase, SampleType type) {
    return beating_frame(beating_grid(size), phase, type);
}

}  // namespace palpate::scenes
