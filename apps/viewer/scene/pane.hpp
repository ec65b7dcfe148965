// A layer with depths as a thing in a VTK scene: what is nearer covers it, what is farther not.
#pragma once

#include <vtkOpenGLQuadHelper.h>
#include <vtkProp.h>
#include <vtkSmartPointer.h>
#include <vtkTextureObject.h>

#include <memory>

#include "apps/viewer/scene/shot.hpp"

namespace palpate::viewer {

/// Fills the viewport, wherever the camera is. Drawn in its turn among the opaque props.
class Pane : public vtkProp {
  public:
    static Pane* New();

    /// Copies the layer at the next drawing; nothing is drawn of one without pixels.
    /// `seen_through`: its alpha is how dense it is, and it leaves depths as they are.
    void set_layer(std::shared_ptr<const Backdrop> owner, const Layer& layer, bool seen_through);
    void clear();

    double* GetBounds() override { return nullptr; }
    int RenderOpaqueGeometry(vtkViewport* viewport) override;
    void ReleaseGraphicsResources(vtkWindow* window) override;

  protected:
    Pane() = default;
    ~Pane() override = default;

  private:
    void upload(vtkOpenGLRenderWindow& window);

    std::shared_ptr<const Backdrop> owner_;
    const Layer* layer_ = nullptr;
    bool seen_through_ = false, uploaded_ = false;
    vtkSmartPointer<vtkTextureObject> colour_, depth_;
    std::unique_ptr<vtkOpenGLQuadHelper> quad_;
};

}  // namespace palpate::viewer
