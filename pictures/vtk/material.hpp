// The materials of surfaces and markers, shared by the picture helper and the viewer's scene.
#pragma once

#include <vtkActor.h>

namespace palpate::pictures {

void look_matt(vtkActor& actor);

/// VTK turns the normal of a triangle that faces away. A sliver that rounding has turned would be a
/// dark dot, so the normal alone decides.
void face_the_viewer(vtkActor& actor);

/// Like glass: clear where one looks straight through, denser towards the outline; `opacity` is
/// that of a part that faces the viewer. It is drawn as if opaque, its nearest part alone, with how
/// dense that is as alpha. 1: not glass.
void set_glass(vtkActor& actor, double opacity);

}  // namespace palpate::pictures
