// Actors of twins, and the order in which the faint ones are drawn.
#include "apps/viewer/scene/twin.hpp"

#include <vtkNew.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <utility>

#include "pictures/vtk/material.hpp"

namespace palpate::viewer {
namespace {

/// Switches the writing of colours, among the opaque props in its turn.
class ColourWriting : public vtkProp {
  public:
    static ColourWriting* New() {
        auto* const made = new ColourWriting;
        made->InitializeObjectBase();
        return made;
    }
    double* GetBounds() override { return nullptr; }
    int RenderOpaqueGeometry(vtkViewport* viewport) override {
        auto* const window = vtkOpenGLRenderWindow::SafeDownCast(
            vtkRenderer::SafeDownCast(viewport)->GetRenderWindow());
        const unsigned char write = on ? 1 : 0;
        window->GetState()->vtkglColorMask(write, write, write, write);
        return 0;
    }
    bool on = true;
};

}  // namespace

Twin twin_of(const pictures::Colour& colour, vtkSmartPointer<vtkPolyData> data) {
    const auto make = [] { return vtkSmartPointer<vtkActor>::New(); };
    Twin twin{make(), make(), make(), std::move(data)};
    for (vtkActor* actor : twin.actors()) {
        vtkNew<vtkPolyDataMapper> mapper;
        mapper->SetInputData(twin.data);
        mapper->ScalarVisibilityOff();
        actor->SetMapper(mapper);
        actor->GetProperty()->SetColor(colour.red, colour.green, colour.blue);
        pictures::look_matt(*actor);
        actor->GetProperty()->SetSpecular(0.35);
        actor->SetVisibility(false);
    }
    twin.faint->GetProperty()->SetOpacity(faint_opacity);
    twin.faint->ForceOpaqueOn();
    return twin;
}

void set_visible(const Twin& twin, bool visible) {
    for (vtkActor* actor : twin.actors()) actor->SetVisibility(visible);
}

/// Depths are drawn first.
void add_faint_actors(vtkRenderer& overlay, std::initializer_list<const Twin*> twins) {
    const auto writing = [&overlay](bool on) {
        vtkNew<ColourWriting> prop;
        prop->on = on;
        overlay.AddViewProp(prop);
    };
    writing(false);
    for (const Twin* twin : twins) overlay.AddActor(twin->depth);
    writing(true);
    for (const Twin* twin : twins) overlay.AddActor(twin->faint);
}

}  // namespace palpate::viewer
