// Ball, torus and ripples, and trajectories over them.
#include "evaluation/fidelity/bodies.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "evaluation/ring.hpp"
#include "palpate/filters/dequantize.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::evaluation {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double radius = 0.35, slope = 1.4;  // of the ball, in a unit box
constexpr double depth = 0.03;                // of the hand, in the same unit
constexpr int turns = 20;

SampleType stored(Samples samples) {
    return samples == Samples::float32 ? SampleType::float32 : SampleType::uint8;
}

Subject with_samples(Subject subject, Samples samples) {
    if (samples == Samples::smoothed) subject.field = Field(smoothed(subject.field.volume()));
    if (samples == Samples::dequantized) {
        subject.field = Field(filters::dequantized(subject.field.volume()));
    }
    return subject;
}

Subject scene(const std::string& specification, Samples samples) {
    return with_samples(synthetic(specification, {}, stored(samples)), samples);
}

Body body_of(Subject subject, const char* trajectory, Samples samples, int grid) {
    Body body(std::move(subject));
    body.trajectory = trajectory;
    body.samples = name_of(samples);
    body.grid = grid;
    body.depth = depth * grid;
    return body;
}

/// No plane of the grid, and no diagonal either.
Mat3 tilted() {
    return Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
}

Body ball(int grid, Samples samples, const char* trajectory,
          std::function<Vec3(double)> direction) {
    Body body = body_of(protocol_ball(grid, samples), trajectory, samples, grid);
    body.hand = [=](double part) { return Vec3((radius - depth) * grid * direction(part)); };
    body.start = 1.5 * body.hand(0);
    body.ideal = [](const Vec3& hand) { return Vec3(hand.normalized()); };
    return body;
}

/// Unit vectors along a spiral from pole to pole: even in z is even over the sphere.
Vec3 spiral(double part) {
    const double z = 1 - 2 * part, angle = 2 * pi * turns * part;
    const double across = std::sqrt(std::max(0.0, 1 - z * z));
    return {across * std::cos(angle), across * std::sin(angle), z};
}

}  // namespace

const char* name_of(Samples samples) {
    switch (samples) {
        case Samples::uint8:
            return "uint8";
        case Samples::smoothed:
            return "uint8 smoothed";
        case Samples::dequantized:
            return "uint8 dequantized";
        case Samples::float32:
            break;
    }
    return "float32";
}

Subject protocol_ball(int grid, Samples samples) {
    const double full = samples == Samples::float32 ? 1 : 255;
    Subject subject{"ball",
                    Field(scenes::ball(Index3::Constant(grid), radius, slope, stored(samples))),
                    0.5 * full};
    subject.exact = [=](const Vec3& p) {
        return full * std::clamp(0.5 + slope * (radius - p.norm() / grid), 0.0, 1.0);
    };
    return with_samples(std::move(subject), samples);
}

Body ball_by_circle(int grid, Samples samples) {
    return ball(grid, samples, "circle", [tilt = tilted()](double part) {
        return Vec3(tilt * Vec3(std::cos(2 * pi * part), std::sin(2 * pi * part), 0));
    });
}

Body ball_by_spiral(int grid, Samples samples) {
    return ball(grid, samples, "spiral",
                [tilt = tilted()](double part) { return Vec3(tilt * spiral(part)); });
}

Body torus_by_helix(int grid, Samples samples) {
    Body body = body_of(scene(fmt::format("torus:{0}x{0}x{1}", grid, grid / 2), samples), "helix",
                        samples, grid);
    // As docs/scenes.md has them: a ring of 0.3 of the box, and at level 0.4 a tube of 0.12.
    const double ring = 0.3 * grid, tube = 0.12 * grid;
    const auto at = [=](double part, double from_ring) {
        const double along = 2 * pi * part, round = turns * along;
        const Vec3 out(std::cos(along), std::sin(along), 0);
        return Vec3(ring * out +
                    from_ring * (std::cos(round) * out + std::sin(round) * Vec3(0, 0, 1)));
    };
    body.hand = [=](double part) { return at(part, tube - depth * grid); };
    body.start = at(0, 1.3 * tube);
    body.ideal = [=](const Vec3& hand) {
        const Vec3 flat(hand[0], hand[1], 0);
        return Vec3((hand - ring * flat.normalized()).normalized());
    };
    return body;
}

Body ripples_by_spiral(int grid, Samples samples) {
    Body body = body_of(scene(fmt::format("marschner-lobb:{0}x{0}x{0}", grid), samples), "spiral",
                        samples, grid);
    // On the level, sin(pi z / 2) is a quarter of the ripple, so the troughs are at -0.161 and the
    // crests at 0.161 of half the box.
    const double half = 0.5 * (grid - 1);
    const double trough = -2 / pi * std::asin(0.25);
    body.depth = std::nan("");  // it goes up and down with the ripples
    body.hand = [=](double part) {
        const double angle = 2 * pi * turns * part;
        const double r = 0.15 + 0.7 * part;
        return Vec3(half * Vec3(r * std::cos(angle), r * std::sin(angle), trough - 2 * depth));
    };
    body.start = body.hand(0) + Vec3(0, 0, half);
    return body;
}

Body body_of(const Subject& subject) {
    const Field& field = subject.field;
    const Geometry& geometry = field.geometry();
    if (field.sign() * (field.background() - subject.isovalue) > 0) {
        throw std::invalid_argument(subject.name +
                                    ": all around the data is solid at this level, so a hand "
                                    "cannot come to it; choose another level");
    }
    Body body(subject);
    body.trajectory = "ring";
    body.samples = name_of(subject.field.volume().type());
    body.grid = geometry.size.maxCoeff();
    body.depth = depth * geometry.size.cast<double>().cwiseProduct(geometry.spacing).minCoeff();
    const Ring ring = ring_round(subject, body.depth);
    body.hand = [=](double part) { return ring.at(part * ring.length()); };
    const Vec3 centre = physical_centre(geometry);
    // Outside the grid, on the ray that found the ring's first point.
    const double outside = geometry.size.cast<double>().cwiseProduct(geometry.spacing).norm();
    body.start = centre + outside * (body.hand(0) - centre).normalized();
    return body;
}

}  // namespace palpate::evaluation
