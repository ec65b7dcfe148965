// An actor for marks over the scene, such as lines, points and handles: no light falls on it.
#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "pictures/scene.hpp"

namespace palpate::viewer {

/// The mesh in one colour. A later change of the mesh is drawn, too.
vtkSmartPointer<vtkActor> flat_actor(vtkPolyData* data, const pictures::Colour& colour);

}  // namespace palpate::viewer
