// The space that a brush reaches: a round one along a line, and a tool's shape between two poses.
#pragma once

#include <vector>

#include "palpate/edit.hpp"

namespace palpate {

/// The width over which a brush's effect falls from full to none [mm].
double edge_of(const Brush& brush, const Vec3& spacing);

/// The capsule of space that a stroke touches, in millimetres along the grid's axes.
class StrokeReach {
  public:
    StrokeReach(const edit::Stroke& stroke, const Geometry& geometry);

    /// 1 inside, 0.5 at the radius, 0 outside.
    double weight(const Index3& at) const;
    SampleBox box() const;

  private:
    Vec3 spacing_, from_, along_;
    double length_squared_, radius_, edge_;
};

/// The space that a sweep touches: the union of its body at poses so near to each other that no
/// point of it moves by more than a quarter of a voxel between two.
class SweepReach {
  public:
    SweepReach(const edit::Sweep& sweep, const Geometry& geometry);

    /// As of a stroke, about the body's skin.
    double weight(const Index3& at) const;
    SampleBox box() const;

  private:
    /// From an index to tool axes: rotation * index + translation [mm].
    struct Placed {
        Mat3 rotation;
        Vec3 translation;
    };
    const ToolBody& body_;
    double radius_, edge_;
    double between_ = 0;  ///< most by which the distance of a place changes between two poses
    std::vector<Placed> poses_;
    SampleBox box_;
};

/// How many poses of a sweep are looked at; more than most_poses where it is too long.
double poses_of(const edit::Sweep& sweep, const Geometry& geometry);
inline constexpr double most_poses = 65'536;

}  // namespace palpate
