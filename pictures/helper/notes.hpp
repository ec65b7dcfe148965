// The annotations of a picture: legend, scale bar, and the cube that shows the directions.
#pragma once

#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <vector>

#include "pictures/scene.hpp"

namespace palpate::pictures {

/// What everything is drawn on.
inline constexpr Colour paper{0.945, 0.953, 0.961};

/// Renderers of this layer of a window. `scale` is how many of the window's pixels are one of the
/// picture.
std::vector<vtkSmartPointer<vtkRenderer>> notes_of(const PictureScene& scene, int scale, int layer);

}  // namespace palpate::pictures
