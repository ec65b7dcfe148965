// Sets up light and camera, renders opaque and transparent parts, and blends them.
#include "pictures/helper/compositor.hpp"

#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>

#include "pictures/helper/layers.hpp"
#include "pictures/helper/notes.hpp"
#include "pictures/vtk/offscreen.hpp"
#include "pictures/vtk/props.hpp"

namespace palpate::pictures {
namespace {

constexpr double ghost_opacity = 0.4;  // of what lies behind a surface

struct Size {
    int width, height;
};

enum class Blending { on, off };

Layer drawn(const std::vector<vtkRenderer*>& renderers, const Size& size,
            Blending blending = Blending::on) {
    const auto window = offscreen_window();
    window->SetSize(size.width, size.height);
    window->SetMultiSamples(0);
    if (blending == Blending::off) keep_alpha(*renderers[0], *window);
    int layers = 1;
    for (vtkRenderer* const renderer : renderers) {
        window->AddRenderer(renderer);
        layers = std::max(layers, renderer->GetLayer() + 1);
    }
    window->SetNumberOfLayers(layers);
    window->Render();
    Layer layer = layer_of(*window);
    for (vtkRenderer* const renderer : renderers) window->RemoveRenderer(renderer);
    return layer;
}

/// A renderer of the scene's space; every drawing has the same camera, so that depths compare.
vtkSmartPointer<vtkRenderer> view_of(vtkCamera* camera,
                                     const std::vector<vtkSmartPointer<vtkActor>>& actors) {
    auto renderer = vtkSmartPointer<vtkRenderer>::New();
    renderer->SetBackground(paper.red, paper.green, paper.blue);
    for (const auto& actor : actors) renderer->AddActor(actor);
    light(*renderer);
    renderer->SetActiveCamera(camera);
    return renderer;
}

/// The scene's bodies are relative to the camera's focus and reach as far as `depth` from it.
vtkSmartPointer<vtkCamera> camera_of(const Camera& wanted, double depth) {
    auto camera = vtkSmartPointer<vtkCamera>::New();
    camera->ParallelProjectionOn();
    camera->SetParallelScale(wanted.half_height);
    camera->SetFocalPoint(0, 0, 0);
    camera->SetPosition(Vec3(1.05 * depth * wanted.towards_viewer.normalized()).data());
    camera->SetViewUp(Vec3(wanted.up).data());
    camera->SetClippingRange(0.02 * depth, 2.08 * depth);
    return camera;
}

/// How far from the focus anything is [mm].
double reach(const std::vector<vtkSmartPointer<vtkActor>>& actors) {
    double farthest = 1e-6;
    for (const auto& actor : actors) {
        const double* const bounds = actor->GetBounds();
        for (int i = 0; i < 6; ++i) farthest = std::max(farthest, std::abs(bounds[i]));
    }
    return std::sqrt(3.0) * farthest;
}

/// Crevices are darker, which shows the shape. Not in a detail: VTK keeps the places of what it
/// sees as 16-bit floats, which are too coarse for it where the picture is a small part of `depth`.
void shade_crevices(vtkRenderer& renderer, const Camera& camera, double depth) {
    const double radius = 0.09 * camera.half_height;
    const double bias = std::max(0.004 * camera.half_height, 0.002 * depth);
    if (bias > 0.2 * radius) return;
    renderer.UseSSAOOn();
    renderer.SetSSAORadius(radius);
    renderer.SetSSAOBias(bias);
    renderer.SetSSAOKernelSize(64);
    renderer.SSAOBlurOn();
}

/// Legend and signs on nothing.
Layer writing(const PictureScene& scene, const Size& size, int scale) {
    vtkNew<vtkRenderer> nothing;
    nothing->SetBackground(0, 0, 0);
    nothing->SetBackgroundAlpha(0);
    std::vector<vtkRenderer*> renderers{nothing};
    const auto notes = notes_of(scene, scale, 1);
    for (const auto& renderer : notes) renderers.push_back(renderer);
    return drawn(renderers, size);
}

}  // namespace

std::vector<unsigned char> pixels_of(const PictureScene& scene,
                                     const std::vector<SharedMesh>& meshes) {
    // Drawn twice as large, where that is no more than a large picture, and reduced: smooth edges.
    const int scale = std::size_t(scene.width) * std::size_t(scene.height) <= 3'000'000 ? 2 : 1;
    const Size size{scale * scene.width, scale * scene.height};
    const auto markers = marker_actors(scene);
    auto solid = markers;
    std::vector<vtkSmartPointer<vtkActor>> glass;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        if (meshes[i].triangles.empty()) continue;
        auto& kind = scene.surfaces[i].opacity < 1 ? glass : solid;
        kind.push_back(surface_actor(scene.surfaces[i], meshes[i]));
    }
    const double depth = std::max(reach(solid), reach(glass));
    const auto camera = camera_of(scene.camera, depth);
    const auto bodies = view_of(camera, solid);
    shade_crevices(*bodies, scene.camera, depth);
    Layer picture = drawn({bodies}, size);
    std::vector<Layer> panes;
    for (const auto& actor : glass)
        panes.push_back(drawn({view_of(camera, {actor})}, size, Blending::off));
    lay_over(picture, panes);
    if (!markers.empty()) {
        shine_through(picture, drawn({view_of(camera, markers)}, size), ghost_opacity);
    }
    lay_over(picture, writing(scene, size, scale));
    return reduced(picture, size.width, size.height, scale);
}

}  // namespace palpate::pictures
