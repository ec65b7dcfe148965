// Paths of the hand for tools.
#include "benchmarks/tool_hand.hpp"

#include <cmath>
#include <numbers>

#include "palpate/scenes/volumes.hpp"

namespace palpate::benchmarks {
namespace {

constexpr int ticks = 4000;
constexpr double step = 0.1;  // voxel a tick; a voxel is a mm

/// With n points along its edges a cube has 6 (n - 1)^2 + 2.
std::shared_ptr<const Tool> cube_of(int points) {
    const double steps = std::max(1.0, std::round(std::sqrt((points - 2) / 6.0)));
    return std::make_shared<const Tool>(box_tool(Vec3::Constant(0.5 * steps), 0.5));
}

/// [mm] of the cube's edge.
double edge_of(const Tool& tool) {
    return 2 * tool.radius() / std::sqrt(3.0);
}

/// A corner of the box towards -z.
Quaternion on_a_corner() {
    return Quaternion::FromTwoVectors(Vec3(-1, -1, -1).normalized(),
                                      Vec3(0.1, -0.2, -1).normalized());
}

/// Round a ball whose surface is 34 mm from the middle; the tool's middle is `height` times its
/// radius from the surface.
ToolTouch round_ball(int points, double height, double turn) {
    ToolTouch touch{
        Field(scenes::ball(Index3::Constant(96)), Solid::above, std::nullopt, Interpolation::cubic),
        0,
        cube_of(points),
        {}};
    constexpr double radius = 34;
    touch.isovalue = value_at(touch.field, Vec3(radius, 0, 0));
    for (int i = 0; i < ticks; ++i) {
        const double angle = 0.6 * std::sin(step * i / radius / 0.6);
        const Quaternion tilt(Eigen::AngleAxisd(angle, Vec3::UnitY()));
        const Quaternion rock(Eigen::AngleAxisd(turn * std::sin(0.02 * i / std::max(turn, 1e-9)),
                                                Vec3(1, 0.3, 0.5).normalized()));
        const Quaternion turned = (tilt * rock * on_a_corner()).normalized();
        touch.path.push_back({tilt * Vec3(0, 0, radius + height * touch.tool->radius()), turned});
    }
    return touch;
}

ToolTouch flat(int points) {
    const Geometry geometry = scenes::centred({64, 64, 64});
    std::vector<float> samples;
    samples.reserve(std::size_t(sample_count(geometry)));
    for (int k = 0; k < 64; ++k) {
        for (int i = 0; i < 64 * 64; ++i) samples.push_back(static_cast<float>(-k));
    }
    ToolTouch touch{Field(Volume(geometry, std::move(samples)), Solid::above, std::nullopt,
                          Interpolation::cubic),
                    -32.3,
                    cube_of(points),
                    {}};
    const double surface = geometry.origin[2] + 32.3;
    for (int i = 0; i < ticks; ++i) {
        const double angle = step * i / 15;
        const Quaternion turned(
            Eigen::AngleAxisd(0.02 * std::sin(0.01 * i), Vec3(1, 2, 0.5).normalized()));
        touch.path.push_back({Vec3(15 * std::cos(angle), 15 * std::sin(angle),
                                   surface + 0.5 * edge_of(*touch.tool) - 0.75),
                              turned});
    }
    return touch;
}

ToolTouch in_noise(int points) {
    ToolTouch touch{Field(scenes::noise(scenes::centred({48, 48, 48}), SampleType::float32, 7, 1),
                          Solid::above, std::nullopt, Interpolation::cubic),
                    0.5,
                    cube_of(points),
                    {}};
    for (int i = 0; i < ticks; ++i) {
        const double t = step * i / 25;
        touch.path.push_back(
            {Vec3(15 * std::sin(t), 15 * std::sin(1.618 * t + 1), 20 * std::sin(2.414 * t + 2)),
             Quaternion(Eigen::AngleAxisd(t, Vec3(1, 2, 3).normalized()))});
    }
    return touch;
}

constexpr ToolCase cases[] = {
    {"tool/hovering", [](int points) { return round_ball(points, 2, 0); }},
    {"tool/corner", [](int points) { return round_ball(points, 0.8, 0); }},
    {"tool/rocking", [](int points) { return round_ball(points, 0.8, 0.3); }},
    {"tool/flat", flat},
    {"tool/noise", in_noise},
};

}  // namespace

std::span<const ToolCase> tool_cases() {
    return cases;
}

}  // namespace palpate::benchmarks
