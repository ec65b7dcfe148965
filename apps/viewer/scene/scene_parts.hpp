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
#include "apps/viewer/scene/layer_prop.hpp"
#include "apps/viewer/scene/markers.hpp"
#include "apps/viewer/scene/marks.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/scene/tool_marks.hpp"
#include "pictures/vtk/props.hpp"

namespace palpate::viewer {

struct Scene::Parts {
    BackgroundRenderer background;
    RenderRequest wanted;  // look, crosshair; changed() fills in the rest
    struct Hand {
        std::optional<Snapshot> snapshot;
        std::shared_ptr<const Tool> tool;
        std::unique_ptr<Markers> markers;
        std::unique_ptr<ToolMarks> tool_marks;
    };
    PerHand<Hand> hands;
    double brush = 0;
    std::vector<Measurement> measurements;
    LengthUnit unit = LengthUnit::automatic;
    std::shared_ptr<const DetailField> patch_detail;  // null: none
    std::optional<double> pressed;                    // to this level
    int pressing = 1;                                 // the hand that does
    std::shared_ptr<const RenderMesh> patch;
    Vec3 patched = Vec3::Zero();  // where, and at which level
    double patched_level = std::nan("");
    bool outdated = true;  // something was set since the layers were drawn

    vtkNew<vtkGenericOpenGLRenderWindow> window;
    vtkNew<vtkRenderer> front, overlay;
    vtkNew<LayerProp> solid, glass;
    Annotations annotations{2};
    std::unique_ptr<CutMarks> cut;
    std::unique_ptr<MeasureMarks> measures;

    void forget_hands() {
        for (Hand& hand : hands) hand.snapshot.reset();
    }
    explicit Parts(MakePainter make_painter) : background(std::move(make_painter)) {
        vtkTimerLog::LoggingOff();  // one log for all threads, unprotected; windows write into it
        window->SetMultiSamples(0);
        window->SetNumberOfLayers(3);
        for (vtkRenderer* renderer : {front.Get(), overlay.Get()}) pictures::light(*renderer);
        overlay->SetLayer(1);
        overlay->SetActiveCamera(front->GetActiveCamera());
        front->AddViewProp(solid);
        for (int hand = 1; hand <= most_hands; ++hand) {
            const HandColours colours = colours_of(hand);
            hands[hand].markers = std::make_unique<Markers>(*front, *overlay, colours);
            hands[hand].tool_marks = std::make_unique<ToolMarks>(*front, *overlay, colours);
        }
        cut = std::make_unique<CutMarks>(*front);
        measures = std::make_unique<MeasureMarks>(*overlay, annotations.writing());
        front->AddViewProp(glass);  // after all that it may cover
        for (vtkRenderer* renderer :
             {front.Get(), overlay.Get(), &annotations.writing(), &annotations.orientation()}) {
            window->AddRenderer(renderer);
        }
    }
};

}  // namespace palpate::viewer
