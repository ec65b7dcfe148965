// OpenGL without a display: Mesa's surfaceless EGL platform, and a VTK window that draws there.
#pragma once

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkSmartPointer.h>

namespace palpate::pictures {

/// A context, current in this thread until the process ends. Throws Failure, saying what to
/// install.
void make_surfaceless_context();

/// A window that draws into memory with the current context.
vtkSmartPointer<vtkGenericOpenGLRenderWindow> surfaceless_window(int width, int height);

}  // namespace palpate::pictures
