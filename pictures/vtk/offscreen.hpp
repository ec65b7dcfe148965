// Draws into memory with the OpenGL context that is current, and reads the image back; shared by
// the picture helper and the viewer's scene.
#pragma once

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "pictures/vtk/layer.hpp"

namespace palpate::pictures {

/// An invisible window of no size yet. Rendering throws std::runtime_error where OpenGL is older
/// than 3.2.
vtkSmartPointer<vtkGenericOpenGLRenderWindow> offscreen_window();

/// A translucent surface keeps its opacity as alpha: VTK switches blending on when it begins, the
/// renderer switches it off again.
void keep_alpha(vtkRenderer& renderer, vtkOpenGLRenderWindow& window);

/// What the window has drawn. Throws std::runtime_error if OpenGL does not return it.
Layer layer_of(vtkRenderWindow& window);

}  // namespace palpate::pictures
