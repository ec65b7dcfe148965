// The space in which render threads and the widget draw, so that their depths compare: physical
// axes, millimetres, from the middle of the grid.
#pragma once

#include <vtkCamera.h>

#include "palpate/volume.hpp"
#include "pictures/scene.hpp"

namespace palpate::viewer {

/// How far from the middle of the grid anything of it is [mm]; what is farther is not drawn.
double reach_of(const Geometry& geometry);

/// Directs VTK's camera. `origin` is the middle of the grid [mm, physical].
void direct(vtkCamera& camera, const pictures::Camera& wanted, const Vec3& origin, double reach);

/// How far towards the viewer from `origin` what has this depth (0 near, 1 far) lies [mm].
double height_of(double depth, double reach);

}  // namespace palpate::viewer
