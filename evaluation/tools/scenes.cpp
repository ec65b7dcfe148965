// Fields, tools and hands.
#include "evaluation/tools/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "palpate/scenes/volumes.hpp"

namespace palpate::evaluation {
namespace {

Field smooth_field(Volume volume) {
    return Field(std::move(volume), Solid::above, std::nullopt, Interpolation::cubic);
}

/// Samples of a function of physical space, whose middle is the origin.
Field sampled(int size, const std::function<double(const Vec3&)>& density) {
    const Geometry geometry = scenes::centred(Index3::Constant(size));
    std::vector<float> samples;
    samples.reserve(static_cast<std::size_t>(sample_count(geometry)));
    for (int k = 0; k < size; ++k) {
        for (int j = 0; j < size; ++j) {
            for (int i = 0; i < size; ++i) {
                samples.push_back(static_cast<float>(density(geometry.origin + Vec3(i, j, k))));
            }
        }
    }
    return smooth_field(Volume(geometry, std::move(samples)));
}

}  // namespace

std::vector<ToolScene> hostile_scenes(std::uint64_t seed) {
    constexpr double wall = 14;
    return {
        {"noise",
         smooth_field(scenes::noise(scenes::centred({32, 32, 32}), SampleType::float32, seed, 1)),
         0.55, 0},
        {"salt", smooth_field(scenes::salt({32, 32, 32}, 0.02, seed)), 60, 0},
        {"shell", sampled(40, [](const Vec3& at) { return 1.5 - std::abs(at.norm() - wall); }),
         0.75, wall}};
}

ToolScene plane_scene() {
    return {"plane", sampled(40, [](const Vec3& at) { return -at[2]; }), 0};
}

ToolScene round_scene() {
    return {"ball", sampled(40, [](const Vec3& at) { return -at.squaredNorm(); }), -144};
}

ToolScene hole_scene() {
    const auto density = [](const Vec3& at) {
        return std::min(std::hypot(at[0], at[1]) - 5, 8 - at[2]);
    };
    return {"hole", sampled(48, density), 0};
}

std::shared_ptr<const Tool> tool_of(int points) {
    if (points == 1) return std::make_shared<const Tool>(point_tool());
    if (points <= 10) return std::make_shared<const Tool>(rod_tool(0.5 * (points - 1), 0.5));
    // A cube with n points along its edges has 6 (n - 1)^2 + 2.
    const double steps = std::round(std::sqrt((points - 2) / 6.0));
    return std::make_shared<const Tool>(box_tool(Vec3::Constant(0.5 * steps), 0.5));
}

std::shared_ptr<const Tool> scalpel() {
    return std::make_shared<const Tool>(box_tool({16, 3.5, 0.4}, 0.5));
}

WildHand::WildHand(double radius, std::uint64_t seed) : radius_(radius), state_(seed) {}

/// Splitmix64.
double WildHand::uniform() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15U;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9U;
    z = (z ^ z >> 27) * 0x94D049BB133111EBU;
    return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53;
}

Vec3 WildHand::direction() {
    const double z = 2 * uniform() - 1, angle = 2 * std::numbers::pi * uniform();
    const double across = std::sqrt(1 - z * z);
    return {across * std::cos(angle), across * std::sin(angle), z};
}

Pose WildHand::next() {
    if (--left_ <= 0) {
        left_ = 20 + static_cast<int>(100 * uniform());
        speed_ = uniform() < 0.3 ? 3 : 0.3 * uniform();
        turning_ = uniform() < 0.3 ? 0.02 : 0.004 * uniform();
    }
    way_ = (way_ + 0.2 * direction()).normalized();
    spin_ = (spin_ + 0.3 * direction()).normalized();
    if (pose_.position.norm() > radius_) way_ = -pose_.position.normalized();
    pose_.position += speed_ * way_;
    pose_.orientation = turned(pose_.orientation, turning_ * spin_);
    return pose_;
}

}  // namespace palpate::evaluation
