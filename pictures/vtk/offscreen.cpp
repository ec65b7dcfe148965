// The invisible window: VTK's, made to work without an X display.
#include "pictures/vtk/offscreen.hpp"

#include <vtkCallbackCommand.h>
#include <vtkNew.h>
#include <vtkOpenGLState.h>
#include <vtkUnsignedCharArray.h>
#include <vtk_glew.h>

#include <stdexcept>

namespace palpate::pictures {
namespace {

/// VTK asks GLEW for the functions of OpenGL, and GLEW, having found them all, complains where
/// there is no X display, which does no harm.
class OffscreenWindow : public vtkGenericOpenGLRenderWindow {
  public:
    // As vtkStandardNewMacro has it, whose semicolons a pedantic compiler refuses.
    static OffscreenWindow* New() {
        auto* const made = new OffscreenWindow;
        made->InitializeObjectBase();
        return made;
    }
    void OpenGLInitContext() override {
        if (this->Initialized) return;
        this->ContextCreationTime.Modified();
        glewExperimental = GL_TRUE;
        const GLenum result = glewInit();
        if ((result != GLEW_OK && result != GLEW_ERROR_NO_GLX_DISPLAY) || !GLEW_VERSION_3_2) {
            throw std::runtime_error("3-D drawing needs OpenGL 3.2 or newer");
        }
        this->GlewInitValid = true;
        this->Initialized = true;
    }
};

void stop_blending(vtkObject*, unsigned long, void* window, void*) {
    static_cast<vtkOpenGLRenderWindow*>(window)->GetState()->vtkglDisable(GL_BLEND);
}

}  // namespace

vtkSmartPointer<vtkGenericOpenGLRenderWindow> offscreen_window() {
    auto window = vtkSmartPointer<OffscreenWindow>::New();
    window->SetIsCurrent(true);
    window->SetIsDirect(1);
    window->SetSupportsOpenGL(1);
    window->SetOffScreenRendering(1);
    window->SetShowWindow(false);
    window->SetAlphaBitPlanes(1);
    return window;
}

void keep_alpha(vtkRenderer& renderer, vtkOpenGLRenderWindow& window) {
    vtkNew<vtkCallbackCommand> before;
    before->SetCallback(stop_blending);
    before->SetClientData(&window);
    renderer.AddObserver(vtkCommand::StartEvent, before);
}

Layer layer_of(vtkRenderWindow& window) {
    const int* const size = window.GetSize();
    const int right = size[0] - 1, top = size[1] - 1;
    const auto count = std::size_t(size[0]) * std::size_t(size[1]);
    Layer layer;
    layer.depth.resize(count);
    vtkNew<vtkUnsignedCharArray> pixels;
    if (window.GetRGBACharPixelData(0, 0, right, top, 0, pixels, 0) != 1 ||
        static_cast<std::size_t>(pixels->GetNumberOfValues()) != 4 * count ||
        window.GetZbufferData(0, 0, right, top, layer.depth.data()) != 1) {
        throw std::runtime_error("OpenGL did not return the picture");
    }
    layer.rgba.assign(pixels->GetPointer(0), pixels->GetPointer(0) + 4 * count);
    return layer;
}

}  // namespace palpate::pictures
