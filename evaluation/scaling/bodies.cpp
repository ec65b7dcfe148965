// Makes balls, row by row because some are large, and great circles round them.
#include "evaluation/scaling/bodies.hpp"

#include <algorithm>
#include <cmath>

#include "palpate/scenes/volumes.hpp"
#include "scenes/random.hpp"

namespace palpate::evaluation {
namespace {

double density(const Ball& shape, double distance) {
    return std::clamp(0.5 + (shape.radius - distance) / shape.edge, 0.0, 1.0);
}

}  // namespace

Subject ball(const Ball& shape) {
    const auto size = static_cast<std::size_t>(shape.size);
    std::vector<std::uint8_t> samples(size * size * size, 0);
    const double middle = 0.5 * (shape.size - 1);
    const double reach = shape.radius + 0.5 * shape.edge;
    std::size_t at = 0;
    for (std::size_t k = 0; k < size; ++k) {
        for (std::size_t j = 0; j < size; ++j, at += size) {
            const double y = double(j) - middle, z = double(k) - middle;
            const double across = y * y + z * z;
            if (across >= reach * reach) continue;
            const double half = std::sqrt(reach * reach - across);
            const auto first = static_cast<std::size_t>(std::max(0.0, std::ceil(middle - half)));
            const auto last = std::min(size, static_cast<std::size_t>(middle + half) + 1);
            for (std::size_t i = first; i < last; ++i) {
                const double x = double(i) - middle;
                const double value = 255 * density(shape, std::sqrt(x * x + across));
                samples[at + i] = static_cast<std::uint8_t>(value + 0.5);
            }
        }
    }
    const Geometry geometry = scenes::centred(Index3::Constant(shape.size));
    return {"ball", Field(Volume(geometry, std::move(samples))), 127.5};
}

Subject noisy_ball(const Ball& shape, double amplitude, std::uint64_t seed) {
    scenes::Random random(seed);
    std::vector<float> samples;
    const double middle = 0.5 * (shape.size - 1);
    for (int k = 0; k < shape.size; ++k) {
        for (int j = 0; j < shape.size; ++j) {
            for (int i = 0; i < shape.size; ++i) {
                const double distance = (Vec3(i, j, k) - Vec3::Constant(middle)).norm();
                const double noise = amplitude * (random.uniform() - 0.5);
                samples.push_back(static_cast<float>(density(shape, distance) + noise));
            }
        }
    }
    const Geometry geometry = scenes::centred(Index3::Constant(shape.size));
    return {"noisy-ball", Field(Volume(geometry, std::move(samples))), 0.5};
}

Trajectory round_the_ball(double radius, double step, int ticks, double from) {
    constexpr double tilt = 0.9;      // [rad] of the circles, off the planes of symmetry
    constexpr double turning = 0.02;  // of the circles' plane, per angle along them
    const auto direction = [&](double angle) {
        const Vec3 flat(std::cos(angle), std::sin(angle) * std::cos(tilt),
                        std::sin(angle) * std::sin(tilt));
        const double c = std::cos(turning * angle), s = std::sin(turning * angle);
        return Vec3(c * flat[0] - s * flat[1], s * flat[0] + c * flat[1], flat[2]);
    };
    Trajectory trajectory{from * direction(0)};
    trajectory.reserve(static_cast<std::size_t>(ticks) + 1);
    for (int i = 0; i < ticks; ++i) trajectory.emplace_back(radius * direction(step / radius * i));
    return trajectory;
}

}  // namespace palpate::evaluation
