// The surfaces and markers of a scene as VTK actors.
#pragma once

#include <vtkActor.h>
#include <vtkSmartPointer.h>

#include <span>
#include <vector>

#include "pictures/scene.hpp"

namespace palpate::pictures {

/// A mesh in the memory that is shared with the caller; nothing is copied, so it has to stay.
struct SharedMesh {
    std::span<float> positions;  ///< relative to the camera's focus
    std::span<float> normals;
    std::span<std::int32_t> triangles;
};

vtkSmartPointer<vtkActor> surface_actor(const Surface& surface, const SharedMesh& mesh);

/// Balls, lines, springs and arrows, relative to the camera's focus.
std::vector<vtkSmartPointer<vtkActor>> marker_actors(const PictureScene& scene);

}  // namespace palpate::pictures
