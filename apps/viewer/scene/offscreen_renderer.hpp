// Draws a render request with VTK, in an invisible window in the current OpenGL context. Belongs to
// one thread, as that context does.
#pragma once

#include <vtkActor.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/scene/render_request.hpp"
#include "apps/viewer/scene/surface_part.hpp"
#include "apps/viewer/scene/volume_part.hpp"

namespace palpate::viewer {

class OffscreenRenderer {
  public:
    /// While `give_up` is true, drawing ends as soon as it can; must outlive the renderer.
    /// `hardware`: OpenGL here is the machine's graphics hardware.
    OffscreenRenderer(const std::atomic<bool>& give_up, bool hardware);
    ~OffscreenRenderer();

    /// Nothing if it was cancelled. Throws std::runtime_error if OpenGL fails.
    std::optional<RenderedImage> draw(const RenderRequest& request);

  private:
    void show(const RenderRequest& request);
    void show_surfaces(const RenderRequest& request);
    void show_surface(SurfacePart& part, const DrawnSurface& surface, bool quick);
    void drop(const std::vector<vtkSmartPointer<vtkActor>>& actors);
    Layer glass_layer(const RenderRequest& request, const Layer& solid);
    void show_slices(const RenderRequest& request);
    void show_box(const RenderRequest& request);
    void show_volume(const RenderRequest& request);
    const Volume& volume_of(const Field& field, bool coarse);
    Layer layer_of(vtkRenderer& renderer);

    const std::atomic<bool>& give_up_;
    vtkSmartPointer<vtkGenericOpenGLRenderWindow> window_;
    vtkSmartPointer<vtkRenderer> solid_, glass_;
    bool hardware_;

    vtkSmartPointer<vtkPlaneCollection> cut_;
    std::vector<SurfacePart> surfaces_;  // as in the request
    std::optional<Field> sliced_;        // what the slices show
    Vec3 crosshair_ = Vec3::Zero();
    std::array<vtkSmartPointer<vtkActor>, 3> slices_;
    std::optional<Geometry> boxed_;
    vtkSmartPointer<vtkActor> box_;
    std::unique_ptr<VolumePart> volume_;
    /// A volume in one piece, and what of.
    struct Cast {
        Field field;
        int every;
        Volume volume;
    };
    std::optional<Cast> cast_;
    bool cast_coarse_ = false;  // another one is to come, even where pictures are not quick ones
    int pixel_ = 1;  // of a moving picture, in pixels of the request: 1, or 2 where that is slow
    double coarseness_ = 3;  // pixels a ray while moving, as quick as it turned out
};

}  // namespace palpate::viewer
