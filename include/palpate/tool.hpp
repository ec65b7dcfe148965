// Tool: a rigid body that touches with the points of its surface, and its solid for edits that have
// the tool's own shape. A point is the simplest tool. Plain values, independent of fields.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "palpate/progress.hpp"
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
/// Structures thinner than the distance between neighbouring points can pass between them.
/// Immutable.
class Tool {
  public:
    /// A single point at the reference point.
    Tool() : Tool({Vec3::Zero()}) {}
    /// `gyration` [mm] weighs rotation against translation: a rotation by an angle counts as much
    /// as a translation by the angle (in radians) times the gyration. Its square is the ratio of
    /// rotational [N mm / rad] to translational stiffness [N / mm] of the coupling whose
    /// equilibrium is the proxy's pose. Default: the root mean square distance of the points from
    /// the reference point. Without `turns` the tool keeps its orientation, as a single point at
    /// the origin always does. `shape` is for pictures only. Throws std::invalid_argument without
    /// points, with more than `most_tool_points`, for points and a gyration beyond 1e6 mm or a
    /// gyration below 1e-6 mm, and for a shape with vertices beyond 1e6 mm or triangles of others.
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
/// A ball around the reference point, which keeps its orientation. Neighbouring points are about
/// `spacing` apart. Here and below, lengths are in mm and > 0, otherwise std::invalid_argument.
Tool sphere_tool(double radius, double spacing);
/// A straight line along z, from the reference point, which is its tip, to `length`.
Tool rod_tool(double length, double spacing);
/// The surface of a box around the reference point.
Tool box_tool(const Vec3& size, double spacing);

/// The rounded tip of a shaft along z, from the reference point, which is the tip, to `length`.
Tool needle_tool(double length, double radius, double spacing);
/// The ball of a surgical burr around the reference point, with its shank along z, 0.4 times as
/// thick and 4 radii long.
Tool burr_tool(double radius, double spacing);
/// The end of a forefinger, 16 mm wide, 12 mm deep and 20 mm long (assumed: an adult's), along z,
/// or `scale` times as large. The reference point is the middle of its rounded end's base, 8 mm
/// from the tip.
Tool fingertip_tool(double spacing, double scale = 1);

/// The surface of a mesh, closed or not, with any orientation of its triangles. Every place on it
/// has a point within `spacing` [mm], and no two points are closer than three quarters of that.
/// Corners and edges (30 degrees) get points first. Throws std::invalid_argument without a triangle
/// that has an area, for vertices that are not finite or missing, and for more points than a tool
/// may have. Exceptions of `progress` are passed on.
Tool mesh_tool(ToolShape mesh, double spacing, const OnProgress& progress = {});

/// A point of the tool in physical space.
inline Vec3 physical_from_tool(const Pose& pose, const Vec3& point) {
    return pose.position + pose.orientation * point;
}
/// The rotation vector (unit axis times angle in radians, at most pi) that turns `from` into `to`,
/// physical axes.
Vec3 rotation_between(const Quaternion& from, const Quaternion& to);
/// Turned by a rotation vector (physical axes), unit again.
Quaternion turned(const Quaternion& from, const Vec3& rotation);
/// Whether a matrix does not mirror and is orthonormal, to this in every number of its transpose
/// times itself.
bool is_rotation(const Mat3& matrix, double tolerance = 1e-6) noexcept;

/// The solid of a rigid tool, as distances from its surface. Immutable. Not for the servo thread,
/// which uses only the tool's points.
///
/// If the tool's shape is closed (each edge has an even number of triangles, with any orientation),
/// the body is the space that it encloses. Otherwise the body is the tool's points, without an
/// inside, and edits work around them as far as their brush does.
class ToolBody {
  public:
    /// Distances are computed at places `step` [mm] apart (farther apart if that would be more than
    /// four million places) and are known up to `reach` [mm] from the surface, on both sides.
    /// Throws std::invalid_argument for a shape of more than 20,000 triangles, a step or reach that
    /// is not from 1e-6 to 1e6 mm, and a reach of more than half a million steps.
    ToolBody(std::shared_ptr<const Tool> tool, double step, double reach);

    /// From the surface to a point in tool axes [mm], below 0 inside. Beyond `reach` the result is
    /// at least `reach`. Between the places it is interpolated linearly.
    double distance(const Vec3& point) const;

    const std::shared_ptr<const Tool>& tool() const { return tool_; }
    bool is_closed() const { return closed_; }
    double step() const { return asked_step_; }
    double reach() const { return reach_; }
    /// The corners of the box around the body [mm, tool axes], without `reach`.
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
