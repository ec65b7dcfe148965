// Inverse kinematics in closed form, forward kinematics by Newton's method. Lengths as measured by
// libnifalcon's authors, with the names of Stamper's thesis (docs/devices/falcon.md).
#include "devices/falcon/kinematics.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>

namespace palpate::devices::falcon {
namespace {

// [m]
constexpr double arm = 0.060;            // a
constexpr double bar = 0.1025;           // b, the long side of the parallelogram
constexpr double side = 2 * 0.01125;     // d + e, its two short links
constexpr double grip_u = 0.014;         // c, from the parallelogram to the middle of the grip
constexpr double grip_v = -0.025;        // f
constexpr double base_u = 0.037233758;   // r, from the middle to the motor
constexpr double base_v = -0.027330909;  // s
constexpr double pi = std::numbers::pi;
constexpr std::array<double, 3> legs{pi / 2 + pi / 12, -pi / 6 + pi / 12, -5 * pi / 6 + pi / 12};

// One count of an encoder is 1/1280 turn of a motor, whose shaft drives the arm's drum.
constexpr double turn_per_count = 2 * pi / 1280 * (0.01425 / 0.110);  // [rad]
constexpr double angle_when_homed = 35 * pi / 180;

constexpr double least_sine = 0.05;  // of the angles between arm and bar that still tell a place

/// The grip in the frame of a leg: u away from the middle, v along the motor's axis, w out.
struct InLeg {
    double u, v, w;
};
InLeg in_leg(const Vec3& p, double turned) {
    const double c = std::cos(turned), s = std::sin(turned);
    return {c * p[0] + s * p[1] - base_u + grip_u, -s * p[0] + c * p[1] - base_v + grip_v, p[2]};
}

/// A leg in its plane u, w: an arm of length a, then the bar's part in the plane.
struct Leg {
    double angle;     // of the arm
    double in_plane;  // sqrt(b^2 - v^2)
    double reach;     // in_plane + d + e
    double du, dw;    // from the arm's end to the grip
};
std::optional<Leg> leg_at(const InLeg& at) {
    const double in_plane = std::sqrt(bar * bar - at.v * at.v);
    const double reach = in_plane + side;
    const double distance = std::hypot(at.u, at.w);
    const double cosine = (distance * distance + arm * arm - reach * reach) / (2 * arm * distance);
    if (!(in_plane > 0 && std::abs(cosine) <= 1)) return std::nullopt;  // NaN too
    const double angle = std::atan2(at.w, at.u) - std::acos(cosine);
    return Leg{angle, in_plane, reach, at.u - arm * std::cos(angle), at.w - arm * std::sin(angle)};
}

}  // namespace

std::optional<Vec3> angles_at(const Vec3& position) {
    Vec3 angles;
    for (int i = 0; i < 3; ++i) {
        const auto leg = leg_at(in_leg(position, legs[static_cast<std::size_t>(i)]));
        if (!leg) return std::nullopt;
        angles[i] = leg->angle;
    }
    return angles;
}

std::optional<Mat3> angle_gradients(const Vec3& position) {
    Mat3 gradients;
    for (int i = 0; i < 3; ++i) {
        const double turned = legs[static_cast<std::size_t>(i)];
        const InLeg at = in_leg(position, turned);
        const auto leg = leg_at(at);
        if (!leg) return std::nullopt;
        // The leg holds g = du^2 + dw^2 - reach^2 at 0. This is half of its gradients.
        const double by_angle =
            arm * (leg->du * std::sin(leg->angle) - leg->dw * std::cos(leg->angle));
        if (!(std::abs(by_angle) > least_sine * arm * leg->reach)) return std::nullopt;
        const Vec3 by_leg(leg->du, leg->reach * at.v / leg->in_plane, leg->dw);
        const double c = std::cos(turned), s = std::sin(turned);
        gradients.row(i) =
            -Vec3(c * by_leg[0] - s * by_leg[1], s * by_leg[0] + c * by_leg[1], by_leg[2])
                 .transpose() /
            by_angle;
    }
    return gradients;
}

std::optional<Vec3> position_with(const Vec3& angles, const Vec3& start) {
    constexpr int most_steps = 20;
    constexpr double longest_step = 0.02, close = 1e-9;  // [m]
    Vec3 position = start;
    for (int i = 0; i < most_steps; ++i) {
        const auto now = angles_at(position);
        const auto gradients = angle_gradients(position);
        if (!now || !gradients || std::abs(gradients->determinant()) < 1e-3) return std::nullopt;
        Vec3 step = gradients->inverse() * (angles - *now);
        if (!step.allFinite()) return std::nullopt;
        if (step.norm() > longest_step) step *= longest_step / step.norm();
        position += step;
        if (step.norm() < close) return position;
    }
    return std::nullopt;
}

std::optional<Vec3> torques_for(const Vec3& force, const Vec3& position) {
    const auto gradients = angle_gradients(position);
    if (!gradients || std::abs(gradients->determinant()) < 1e-3) return std::nullopt;
    return Vec3(gradients->transpose().inverse() * force);
}

Vec3 angles_from(const Eigen::Vector3i& encoders) {
    return turn_per_count * encoders.cast<double>() + Vec3::Constant(angle_when_homed);
}

Eigen::Vector3i encoders_at(const Vec3& angles) {
    const Vec3 counts = (angles - Vec3::Constant(angle_when_homed)) / turn_per_count;
    return {static_cast<int>(std::lround(counts[0])), static_cast<int>(std::lround(counts[1])),
            static_cast<int>(std::lround(counts[2]))};
}

}  // namespace palpate::devices::falcon
