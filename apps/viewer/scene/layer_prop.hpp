// A rendered image with depths as a prop in a VTK scene: nearer props cover it, farther ones do
// not.
#pragma once

#include <vtkOpenGLQuadHelper.h>
#include <vtkProp.h>
#include <vtkSmartPointer.h>
#include <vtkTextureObject.h>

#include <memory>

#include "apps/viewer/scene/render_request.hpp"

namespace palpate::viewer {

/// Fills the viewport, wherever the camera is. Drawn in its turn among the opaque props.
class LayerProp : public vtkProp {
  public:
    static LayerProp* New();

    /// Copies the layer at the next drawing; nothing is drawn of one without pixels.
    /// `translucent`: its alpha is its opacity, and it does not write depths.
    void set_layer(std::shared_ptr<const RenderedImage> owner, const Layer& layer,
                   bool translucent);
    void clear();

    double* GetBounds() override { return nullptr; }
    int RenderOpaqueGeometry(vtkViewport* viewport) override;
    void ReleaseGraphicsResources(vtkWindow* window) override;

  protected:
    LayerProp() = default;
    ~LayerProp() override = default;

  private:
    void upload(vtkOpenGLRenderWindow& window);

    std::shared_ptr<const RenderedImage> owner_;
    const Layer* layer_ = nullptr;
    bool translucent_ = false, uploaded_ = false;
    vtkSmartPointer<vtkTextureObject> colour_, depth_;
    std::unique_ptr<vtkOpenGLQuadHelper> quad_;
};

}  // namespace palpate::viewer
