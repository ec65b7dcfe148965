// What the tools of the experiment meet, and hands that carry them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "palpate/tool_proxy.hpp"

namespace palpate::evaluation {

/// On the smooth field; a voxel is a mm.
struct ToolScene {
    std::string name;
    Field field;
    double isovalue = 0;
    /// [mm] of a closed wall round the middle, inside which the tool starts and stays; 0: none.
    double wall = 0;
};
/// White noise, grains of salt, and a ball's shell, 1.5 voxels thick.
std::vector<ToolScene> hostile_scenes(std::uint64_t seed);
/// Solid below z = 0, density falling by one a mm.
ToolScene plane_scene();
/// Solid: a ball round the middle, density falling with the square of the distance, so that the
/// smooth field's surface is a ball, too.
ToolScene round_scene();
/// Solid round a hole along z of 5 mm radius, up to z = 8.
ToolScene hole_scene();

/// A tool of about so many points, half a voxel apart.
std::shared_ptr<const Tool> tool_of(int points);
/// A scalpel: a thin blade of 528 points.
std::shared_ptr<const Tool> scalpel();

/// Goes by up to 3 voxels and 0.02 rad a tick (3 m/s and 20 rad/s at 1 kHz), now slowly, now fast,
/// within a ball.
class WildHand {
  public:
    WildHand(double radius, std::uint64_t seed);
    Pose next();

  private:
    double uniform();
    Vec3 direction();

    double radius_;
    std::uint64_t state_;
    Pose pose_;
    Vec3 way_ = Vec3::UnitX(), spin_ = Vec3::UnitZ();
    double speed_ = 0.1, turning_ = 0.01;
    int left_ = 0;
};

}  // namespace palpate::evaluation
