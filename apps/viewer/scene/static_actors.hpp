// VTK actors of the slices in the scene and of the grid's outline.
#pragma once

#include <vtkActor.h>
#include <vtkSmartPointer.h>

#include <array>

#include "palpate/field.hpp"

namespace palpate::viewer {

/// Three planes of the grid through a point, grey from the least sample to the greatest, at the
/// field's moment; hidden where all of it is as good as black. Positions from the middle of the
/// grid.
std::array<vtkSmartPointer<vtkActor>, 3> slice_actors(const Field& field, const Vec3& crosshair);

/// The twelve edges of the box whose corners are the outermost samples.
vtkSmartPointer<vtkActor> box_actor(const Geometry& geometry);

}  // namespace palpate::viewer
