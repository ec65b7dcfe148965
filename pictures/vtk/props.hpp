// The lights, orientation cube and scale bar of every 3-D picture, in VTK, shared by the picture
// helper and the viewer's scene.
#pragma once

#include <vtkAnnotatedCubeActor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <string>

namespace palpate::pictures {

/// From over the viewer's left shoulder, with weaker lamps that keep the shadows from going black.
/// They go with the camera.
void light(vtkRenderer& renderer);

/// A cube with the sides of the body on it (LPS): L, R, A, P, S, I.
vtkSmartPointer<vtkAnnotatedCubeActor> body_cube();

/// 1, 2 or 5 times a power of ten: the greatest that is at most `most` (> 0).
double round_length(double most);
/// A length [mm] as people read it: "20 mm", "500 µm".
std::string in_millimetres(double length);

}  // namespace palpate::pictures
