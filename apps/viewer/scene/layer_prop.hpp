// Rendered images with depths: put over each other, and as a prop in a VTK scene.
#pragma once

#include <vtkOpenGLQuadHelper.h>
#include <vtkProp.h>
#include <vtkSmartPointer.h>
#include <vtkTextureObject.h>

#include <memory>
#include <vector>

#include "apps/viewer/scene/render_request.hpp"
#include "pictures/vtk/layer.hpp"

namespace palpate::viewer {

/// One layer that looks as all of them do, the nearest first at each pixel, without what lies
/// behind `solid`; its depth is the nearest one's. Colours are not multiplied by alpha. Empty
/// without layers. All must have as many pixels.
pictures::Layer composed(std::vector<pictures::Layer> layers, const pictures::Layer& solid);

/// Fills the viewport, wherever the camera is. Drawn in its turn among the opaque props. An image
/// of another shape, from before a change of size, keeps its shape and fills the viewport's height.
class LayerProp : public vtkProp {
  public:
    static LayerProp* New();

    /// Copies the layer at the next drawing; nothing is drawn of one without pixels.
    /// `translucent`: its alpha is its opacity, and it does not write depths.
    void set_layer(std::shared_ptr<const RenderedImage> owner, const pictures::Layer& layer,
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
    double across(vtkViewport& viewport) const;

    std::shared_ptr<const RenderedImage> owner_;
    const pictures::Layer* layer_ = nullptr;
    bool translucent_ = false, uploaded_ = false;
    vtkSmartPointer<vtkTextureObject> colour_, depth_;
    std::unique_ptr<vtkOpenGLQuadHelper> quad_;
};

}  // namespace palpate::viewer
