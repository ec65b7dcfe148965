// Sorts layers by depth at each pixel, and draws one on a rectangle in the viewport.
#include "apps/viewer/scene/layer_prop.hpp"

#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLShaderCache.h>
#include <vtkOpenGLState.h>
#include <vtkRenderer.h>
#include <vtkShaderProgram.h>
#include <vtk_glew.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpate::viewer {
namespace {

/// `front` over `back`, of one pixel.
void put_over(const unsigned char* front, const std::array<double, 4>& back,
              std::array<double, 4>& out) {
    const double a = front[3] / 255.0;
    const double alpha = a + (1 - a) * back[3];
    for (std::size_t c = 0; c < 3; ++c) {
        out[c] = alpha > 0 ? (a * front[c] + (1 - a) * back[3] * back[c]) / alpha : 0;
    }
    out[3] = alpha;
}

}  // namespace

pictures::Layer composed(std::vector<pictures::Layer> layers, const pictures::Layer& solid) {
    if (layers.empty()) return {};
    if (layers.size() == 1) return std::move(layers.front());
    pictures::Layer result = std::move(layers.front());
    layers.erase(layers.begin());
    std::vector<std::pair<float, const unsigned char*>> at;
    std::vector<unsigned char> first(4);
    for (std::size_t i = 0; i < result.depth.size(); ++i) {
        unsigned char* const pixel = result.rgba.data() + 4 * i;
        at.clear();
        const auto add = [&](float depth, const unsigned char* rgba) {
            if (depth < 1 && depth < solid.depth[i] && rgba[3] > 0) at.emplace_back(depth, rgba);
        };
        std::copy_n(pixel, 4, first.begin());
        add(result.depth[i], first.data());
        for (const pictures::Layer& layer : layers) add(layer.depth[i], layer.rgba.data() + 4 * i);
        std::ranges::sort(at, {}, [](const auto& one) { return one.first; });
        std::array<double, 4> sum{};
        for (auto one = at.rbegin(); one != at.rend(); ++one) {
            const std::array<double, 4> back = sum;
            put_over(one->second, back, sum);
        }
        result.depth[i] = at.empty() ? 1 : at.front().first;
        for (std::size_t c = 0; c < 3; ++c) {
            pixel[c] = static_cast<unsigned char>(std::lround(sum[c]));
        }
        pixel[3] = static_cast<unsigned char>(std::lround(255 * sum[3]));
    }
    return result;
}

namespace {

constexpr const char* shader = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec2 texCoord;
uniform sampler2D colours;
uniform sampler2D depths;
uniform float across;
void main() {
  vec2 at = vec2(0.5 + across * (texCoord.x - 0.5), texCoord.y);
  if (at.x < 0.0 || at.x > 1.0) discard;
  gl_FragData[0] = texture(colours, at);
  gl_FragDepth = texture(depths, at).r;
}
)";

vtkSmartPointer<vtkTextureObject> texture(vtkOpenGLRenderWindow& window) {
    auto made = vtkSmartPointer<vtkTextureObject>::New();
    made->SetContext(&window);
    made->SetMinificationFilter(vtkTextureObject::Nearest);
    made->SetMagnificationFilter(vtkTextureObject::Nearest);
    made->SetWrapS(vtkTextureObject::ClampToEdge);
    made->SetWrapT(vtkTextureObject::ClampToEdge);
    return made;
}

}  // namespace

LayerProp* LayerProp::New() {
    auto* const made = new LayerProp;
    made->InitializeObjectBase();
    return made;
}

void LayerProp::set_layer(std::shared_ptr<const RenderedImage> owner, const pictures::Layer& layer,
                          bool translucent) {
    owner_ = std::move(owner);
    layer_ = &layer;
    translucent_ = translucent;
    uploaded_ = false;
    this->Modified();
}

void LayerProp::clear() {
    owner_.reset();
    layer_ = nullptr;
    this->Modified();
}

void LayerProp::upload(vtkOpenGLRenderWindow& window) {
    if (!colour_) colour_ = texture(window);
    if (!depth_) depth_ = texture(window);
    const auto width = static_cast<unsigned>(owner_->width);
    const auto height = static_cast<unsigned>(owner_->height);
    // The call only reads them.
    colour_->Create2DFromRaw(width, height, 4, VTK_UNSIGNED_CHAR,
                             const_cast<unsigned char*>(layer_->rgba.data()));
    depth_->Create2DFromRaw(width, height, 1, VTK_FLOAT, const_cast<float*>(layer_->depth.data()));
    uploaded_ = true;
}

/// Widths of the image in that of the viewport, if it is as high.
double LayerProp::across(vtkViewport& viewport) const {
    const auto [width, height] = std::pair{viewport.GetSize()[0], viewport.GetSize()[1]};
    const double ratio = double(width) * owner_->height / (double(height) * owner_->width);
    constexpr double rounding = 0.01;  // of images with fewer pixels
    return std::abs(ratio - 1) < rounding ? 1 : ratio;
}

int LayerProp::RenderOpaqueGeometry(vtkViewport* viewport) {
    if (!layer_ || layer_->rgba.empty()) return 0;
    auto* const renderer = vtkRenderer::SafeDownCast(viewport);
    auto* const window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
    if (!uploaded_) upload(*window);
    const bool enlarged = owner_->width != viewport->GetSize()[0];
    colour_->SetMagnificationFilter(enlarged ? vtkTextureObject::Linear
                                             : vtkTextureObject::Nearest);
    if (!quad_) {
        quad_ = std::make_unique<vtkOpenGLQuadHelper>(window, nullptr, shader, "");
    } else {
        window->GetShaderCache()->ReadyShaderProgram(quad_->Program);
    }
    vtkOpenGLState* const state = window->GetState();
    const vtkOpenGLState::ScopedglEnableDisable depth_test(state, GL_DEPTH_TEST);
    const vtkOpenGLState::ScopedglEnableDisable blend(state, GL_BLEND);
    const vtkOpenGLState::ScopedglDepthMask mask(state);
    const vtkOpenGLState::ScopedglDepthFunc function(state);
    state->vtkglEnable(GL_DEPTH_TEST);
    state->vtkglDepthFunc(translucent_ ? GL_LESS : GL_ALWAYS);
    state->vtkglDepthMask(translucent_ ? GL_FALSE : GL_TRUE);
    translucent_ ? state->vtkglEnable(GL_BLEND) : state->vtkglDisable(GL_BLEND);
    colour_->Activate();
    depth_->Activate();
    quad_->Program->SetUniformi("colours", colour_->GetTextureUnit());
    quad_->Program->SetUniformi("depths", depth_->GetTextureUnit());
    quad_->Program->SetUniformf("across", static_cast<float>(across(*viewport)));
    quad_->Render();
    colour_->Deactivate();
    depth_->Deactivate();
    return 1;
}

void LayerProp::ReleaseGraphicsResources(vtkWindow* window) {
    quad_.reset();
    if (colour_) colour_->ReleaseGraphicsResources(window);
    if (depth_) depth_->ReleaseGraphicsResources(window);
    colour_ = nullptr;
    depth_ = nullptr;
    uploaded_ = false;
}

}  // namespace palpate::viewer
