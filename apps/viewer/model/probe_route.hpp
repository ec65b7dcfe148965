// Finds the first surface point on the way into a picture, and a way for the hand to it from in
// front.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// How far the grid reaches along a unit vector, from physical 0 [mm], with two voxels of room: the
/// surface at its border lies in the first.
struct DepthExtent {
    double back = 0, front = 0;
};
DepthExtent extent_along(const Geometry& geometry, const Vec3& towards);

/// Where the surface is first met under a point of the picture, seen from `towards` (a unit vector
/// to the viewer) [mm, physical]. `cuts` remove everything on the side to which their normals
/// point. Nothing beside the surface, and where the line of sight begins in the
/// solid, at the border of the grid or at a cut.
std::optional<Vec3> surface_under(const Field& field, double isovalue, const Vec3& at,
                                  const Vec3& towards, std::span<const CutPlane> cuts = {});

/// Where a tool's reference point is when the tool, coming from the viewer over a point of the
/// picture, first touches. `points`: of the tool, turned as it is [mm, physical axes]. Nothing
/// where surface_under() finds nothing.
std::optional<Vec3> tool_on_surface(const Field& field, double isovalue, const Vec3& at,
                                    const Vec3& towards, std::span<const Vec3> points,
                                    std::span<const CutPlane> cuts = {});

/// As surface_under(), under the middle of the grid, or under the point nearest to it that has a
/// surface.
std::optional<Vec3> surface_in_view(const Field& field, double isovalue, const Vec3& towards,
                                    const Vec3& up);

/// The side from which a hand comes to a point.
struct Approach {
    Vec3 towards = Vec3::UnitZ();  ///< a unit vector to where it comes from
    std::optional<Vec3> surface =
        {};  ///< where the tool touches on the way; nothing: the way is free
};
/// To a point of a slice. The side is that of the viewer, the outside of the surface at the point,
/// or an axis of the grid: the first one from which at most a voxel of the solid is in the way, or
/// else the one with the least solid. Nothing if the solid reaches out of the grid on all sides.
std::optional<Approach> approach_to(const Field& field, double isovalue, const Vec3& to,
                                    const Vec3& towards_viewer, std::span<const Vec3> points);

/// The stops of a hand that draws back out of the grid to the side `leaving`, goes round it to the
/// side `towards` (both unit vectors), and forward to `to` [mm, physical].
std::vector<Vec3> route_in_front(const Geometry& geometry, const Vec3& from, const Vec3& to,
                                 const Vec3& leaving, const Vec3& towards);

}  // namespace palpate::viewer
