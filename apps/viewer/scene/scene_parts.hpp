// What the 3-D view is made of; for its own sources alone.
#pragma once

#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkRenderer.h>
#include <vtkTimerLog.h>

#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/scene/background_renderer.hpp"
#include "apps/viewer/scene/hand_marks.hpp"
#include "apps/viewer/scene/layer_prop.hpp"
#include "apps/viewer/scene/marks.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "pictures/vtk/props.hpp"

namespace palpate::viewer {

struct Scene::Parts {
    BackgroundRenderer background;
    Shown shown;
    Look look;  // of it, with its layers
    PerHand<SeenHand> hands;
    HandShapes shapes;
    std::shared_ptr<const DetailField> patch_detail;  // null: none
    std::shared_ptr<const RenderMesh> patch;
    vtkSmartPointer<vtkPolyData> patch_shape;
    Vec3 patched = Vec3::Zero();  // where, and at which level
    double patched_level = std::nan("");
    bool outdated = true;  // something was set since the layers were drawn

    vtkNew<vtkGenericOpenGLRenderWindow> window;
    vtkNew<vtkRenderer> front, overlay;
    vtkNew<LayerProp> solid, glass;
    vtkNew<MarkProp> marks, faint_marks;
    Annotations annotations{2};

    void forget_hands() {
        for (SeenHand& hand : hands) hand.snapshot.reset();
    }
    explicit Parts(MakePainter make_painter) : background(std::move(make_painter)) {
        vtkTimerLog::LoggingOff();  // one log for all threads, unprotected; windows write into it
        window->SetMultiSamples(0);
        window->SetNumberOfLayers(3);
        for (vtkRenderer* renderer : {front.Get(), overlay.Get()}) pictures::light(*renderer);
        overlay->SetLayer(1);
        overlay->SetActiveCamera(front->GetActiveCamera());
        front->AddViewProp(solid);
        front->AddViewProp(marks);
        faint_marks->draw_faint_ones();
        overlay->AddViewProp(faint_marks);
        for (int hand = 1; hand <= most_hands; ++hand) hands[hand].colours = colours_of(hand);
        front->AddViewProp(glass);  // after all that it may cover
        for (vtkRenderer* renderer :
             {front.Get(), overlay.Get(), &annotations.writing(), &annotations.orientation()}) {
            window->AddRenderer(renderer);
        }
    }
};

}  // namespace palpate::viewer
