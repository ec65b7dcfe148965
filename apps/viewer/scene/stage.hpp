// What a painter draws with: VTK in a window that nobody sees, in whatever OpenGL context is
// current. Lives and dies in one thread, with that context.
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

#include "apps/viewer/scene/shot.hpp"
#include "apps/viewer/scene/surface_part.hpp"
#include "apps/viewer/scene/volume_part.hpp"

namespace palpate::viewer {

class Stage {
  public:
    /// While `give_up` is true, drawing ends as soon as it can; must outlive the stage.
    /// `hardware`: OpenGL here is the machine's graphics hardware.
    Stage(const std::atomic<bool>& give_up, bool hardware);
    ~Stage();
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

    /// Nothing if it was given up. Throws std::runtime_error if OpenGL does not do it.
    std::optional<Backdrop> draw(const Shot& shot);

  private:
    void show(const Shot& shot);
    void show_surface(const Shot& shot);
    void show_slices(const Shot& shot);
    void show_box(const Shot& shot);
    void show_volume(const Shot& shot);
    const Volume& volume_of(const Field& field, bool coarse);
    Layer layer_of(vtkRenderer& renderer, int width, int height);

    const std::atomic<bool>& give_up_;
    vtkSmartPointer<vtkGenericOpenGLRenderWindow> window_;
    vtkSmartPointer<vtkRenderer> solid_, glass_;
    bool hardware_;

    SurfacePart surface_;
    std::optional<Field> sliced_;  // what the slices show
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
    int pixel_ = 1;  // of a moving picture, in pixels of the shot: 1, or 2 where that is slow
    double coarseness_ = 3;  // pixels a ray while moving, as quick as it turned out
};

}  // namespace palpate::viewer
