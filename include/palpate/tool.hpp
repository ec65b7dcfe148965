// Tool: a rigid body that touches with the points of its surface, and its solid for edits that have
// the tool's own shape. A point is the simplest tool. Plain values; nothing here knows of fields.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "palpate/volume.hpp"

namespace palpate {

using Quaternion = Eigen::Quaterniond;

/// Position and orientation of a rigid body.
struct Pose {
    Vec3 position = Vec3::Zero();                     ///< of its reference point [mm, physical]
    Quaternion orientation = Quaternion::Identity();  ///< unit; from tool axes to physical axes
};

/// Force and torque on the hand.
struct Wrench {
    Vec3 force = Vec3::Zero();   ///< [N]
    Vec3 torque = Vec3::Zero();  ///< [N mm] about the reference point
};

inline constexpr std::size_t most_tool_points = 20'000;

/// Triangles in tool axes [mm].
struct ToolShape {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The points with which a tool touches, in its own axes, its reference point at their origin.
/// Things thinner than the distance of neighbouring points pass between them. Immutable.
class Tool {
  public:
    /// A single point at the reference point.
    Tool() : Tool({Vec3::Zero()}) {}
    /// `gyration` [mm] weighs rotation against translation: to turn by an angle counts as much as
    /// to move by the angle (in radians) times it. Its square is the quotient of rotational
    /// [N mm / rad] and translational stiffness [N / mm] of a coupling that finds the proxy's pose
    /// in equilibrium. Default: the root of the points' mean squared distance from the reference
    /// point. Without `turns` the tool keeps its orientation, which a single point at the origin
    /// always does. `shape` is what it looks like; nothing is felt of it. Throws
    /// std::invalid_argument without points, with more than `most_tool_points`, for points and a
    /// gyration beyond 1e6 mm or a gyration below 1e-6 mm, and for a shape with vertices beyond
    /// 1e6 mm or triangles of others.
    explicit Tool(std::vector<Vec3> points, std::optional<double> gyration = std::nullopt,
                  bool turns = true, ToolShape shape = {});

    std::span<const Vec3> points() const { return points_; }  ///< [mm]
    double gyration() const { return gyration_; }             ///< [mm]
    double radius() const { return radius_; }  ///< of the farthest point from the origin [mm]
    bool turns() const { return turns_; }
    const ToolShape& shape() const { return shape_; }  ///< may be empty

  private:
    std::vector<Vec3> points_;
    double gyration_ = 1;
    double radius_ = 0;
    bool turns_ = true;
    ToolShape shape_;
};

/// One point at the reference point.
Tool point_tool();
/// A ball round the reference point. Neighbouring points are about `spacing` apart. Lengths in mm,
/// > 0, here and below: std::invalid_argument. It need not turn.
Tool sphere_tool(double radius, double spacing);
/// A straight line along z, from the reference point, which is its tip, to `length`.
Tool rod_tool(double length, double spacing);
/// The surface of a box round the reference point.
Tool box_tool(const Vec3& size, double spacing);

/// The rounded tip of a shaft along z, from the reference point, which is the tip, to `length`.
Tool needle_tool(double length, double radius, double spacing);
/// The ball of a surgical burr round the reference point, with its shank along z, 0.4 times as
/// thick and 4 radii long.
Tool burr_tool(double radius, double spacing);
/// The end of a forefinger, 16 mm wide, 12 mm deep and 20 mm long (assumed: an adult's), along z,
/// or `scale` times as large. The reference point is the middle of its rounded end's base, 8 mm
/// from the tip.
Tool fingertip_tool(double spacing, double scale = 1);

/// The surface of a mesh, closed or not, its triangles turned either way: no place on it is farther
/// than `spacing` [mm] from a point, and no two points are nearer than three quarters of it;
/// corners and edges (30 degrees) have theirs first. Throws std::invalid_argument without a
/// triangle that has an area, for vertices that are not finite or not there, and for more points
/// than a tool may have.
Tool mesh_tool(ToolShape mesh, double spacing);

/// A point of the tool in physical space.
inline Vec3 physical_from_tool(const Pose& pose, const Vec3& point) {
    return pose.position + pose.orientation * point;
}
/// The rotation vector (unit axis times angle in radians, at most pi) that turns `from` into `to`,
/// physical axes.
Vec3 rotation_between(const Quaternion& from, const Quaternion& to);
/// Turned by a rotation vector (physical axes), unit again.
Quaternion turned(const Quaternion& from, const Vec3& rotation);

/// The solid of a rigid tool as distances from its skin. Immutable. Not for the servo thread, which
/// feels a tool with its points alone.
///
/// If the tool's shape is closed (each edge has an even number of triangles, turned either way)
/// the body is what it encloses. Otherwise the body is the tool's points, which has no inside:
/// edits reach as far round them as their brush says.
class ToolBody {
  public:
    /// Distances are computed at places `step` [mm] apart (farther where that would be more than
    /// four million) and are known up to `reach` [mm] from the skin, on both sides. Throws
    /// std::invalid_argument for a shape of more than 20,000 triangles, a step or reach that is not
    /// from 1e-6 to 1e6 mm, and a reach of more than half a million steps.
    ToolBody(std::shared_ptr<const Tool> tool, double step, double reach);

    /// From the skin to a point in tool axes [mm], below 0 inside. Beyond the reach it is at least
    /// that. Between the places it is interpolated linearly.
    double distance(const Vec3& point) const;

    const std::shared_ptr<const Tool>& tool() const { return tool_; }
    bool is_closed() const { return closed_; }
    double step() const { return asked_step_; }
    double reach() const { return reach_; }
    /// The corners of the box round the body [mm, tool axes], without its reach.
    const Vec3& low() const { return low_; }
    const Vec3& high() const { return high_; }

  private:
    std::shared_ptr<const Tool> tool_;
    double asked_step_, reach_;
    double step_;  // of the places
    bool closed_ = false;
    Vec3 low_, high_;
    Vec3 first_;  // the first place
    Index3 size_;
    std::vector<float> distances_;  // x fastest
};

}  // namespace palpate
