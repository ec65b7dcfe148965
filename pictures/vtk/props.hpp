// The lights, orientation cube and scale bar of every 3-D picture, in VTK, shared by the picture
// helper and the viewer's scene.
#pragma once

#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <string>

#include "palpate/volume.hpp"

namespace palpate::pictures {

/// From over the viewer's left shoulder, with weaker lamps that keep the shadows from going black.
/// They go with the camera.
void light(vtkRenderer& renderer);

/// A cube with the sides of the body on it (LPS): L, R, A, P, S, I, or, where they are not known,
/// the ends of the axes: +X, -X. Alone in a renderer, which shows it from a side with
/// turn_orientation().
vtkSmartPointer<vtkRenderer> orientation_view(int layer);
void turn_orientation(vtkRenderer& view, const Vec3& towards_viewer, const Vec3& up, bool oriented);

/// A bar in the lower right corner of a picture, in pixels.
struct ScaleBar {
    vtkSmartPointer<vtkPolyData> shape;
    std::string text;  ///< its length, as people read it
    double middle;     ///< of the bar, to the right
};
/// At most about a fifth of the width: 1, 2 or 5 times a power of ten. `em`: height of the writing,
/// `thick`: of the bar; its lower edge is at 1.1 em.
ScaleBar scale_bar(double width, double pixels_per_mm, double em, double thick);

}  // namespace palpate::pictures
