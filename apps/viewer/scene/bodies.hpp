// What stands still, as VTK's actors: the isosurface in parts, slices and the grid's outline.
#pragma once

#include <vtkActor.h>
#include <vtkSmartPointer.h>

#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "apps/viewer/scene/shot.hpp"

namespace palpate::viewer {

/// A mesh, without graphics hardware in parts, none so large that drawing it is long: between two
/// of them drawing can be given up. `give_up` must outlive the actors.
std::vector<vtkSmartPointer<vtkActor>> mesh_actors(const std::shared_ptr<const DrawnMesh>& mesh,
                                                   bool hardware, const std::atomic<bool>& give_up);
/// Three planes of the grid through a point, grey from the least sample to the greatest. Positions
/// from the middle of the grid.
std::array<vtkSmartPointer<vtkActor>, 3> slice_actors(const Volume& volume, const Vec3& crosshair);

/// The twelve edges of the box whose corners are the outermost samples.
vtkSmartPointer<vtkActor> box_actor(const Geometry& geometry);

}  // namespace palpate::viewer
