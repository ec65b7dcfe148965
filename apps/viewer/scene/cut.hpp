// Cuts of the scene: their planes, and handles by which they are moved with the mouse. Points are
// physical [mm].
#pragma once

#include <vtkPlaneCollection.h>

#include <array>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "palpate/volume.hpp"

namespace palpate::viewer {

/// As many as cut something: a box that reaches the grid's ends there has none. [mm, physical]
std::vector<CutPlane> planes_of(const Look& look, const Geometry& geometry);

/// Puts them into VTK's collection, from `origin`; touches it only where they differ.
void put_planes(vtkPlaneCollection& collection, const std::vector<CutPlane>& planes,
                const Vec3& origin);

/// The point of the box at parts of the grid along its axes [mm, physical].
Vec3 at_parts(const Geometry& geometry, const Vec3& parts);

/// Handles by which a cut is moved with the mouse, in plain arithmetic. Points are physical [mm].
struct CutHandle {
    Vec3 at = Vec3::Zero();
    Vec3 along = Vec3::Zero();  ///< unit: it moves on this line; zero: freely
};

/// Of a plane: its point, and the tip of its normal, `arm` [mm] away, which turns it. Of a box: the
/// middles of its faces, along axis 0 low and high, then 1, 2.
std::vector<CutHandle> handles_of(const Look& look, const Geometry& geometry, double arm);

/// The look with this handle moved to `to`, on its line, as far as that is possible.
Look with_handle_at(const Look& look, const Geometry& geometry, std::size_t handle, const Vec3& to);

/// Lines that show the cut: where the plane meets the grid's bounds, or the edges of the box.
std::vector<std::array<Vec3, 2>> outline_of(const Look& look, const Geometry& geometry);

/// Through `point`, facing the viewer; a box is as large as the grid.
Look with_cut(const Look& look, Cut cut, const Vec3& point, const Vec3& towards_viewer);

}  // namespace palpate::viewer
