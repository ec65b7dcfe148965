// What is to be drawn, the image of it, and the painter that makes one from the other: values and
// immutable shared data. No VTK.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "apps/viewer/scene/render_mesh.hpp"
#include "palpate/field.hpp"
#include "pictures/scene.hpp"
#include "pictures/vtk/layer.hpp"

namespace palpate::viewer {

struct DrawnSurface {
    ExtractedSurface surface;
    Colour colour;
    double opacity = 1;           ///< 0: not drawn
    Vec3 offset = Vec3::Zero();   ///< [mm] of its origin from the middle of the grid
    ExtractedSurface finer = {};  ///< in place of a part of it, unless that has no bounds

    bool operator==(const DrawnSurface&) const = default;
};

/// The static part of the scene, which does not follow the hand, seen by one camera.
struct RenderRequest {
    std::uint64_t number = 0;            ///< rising with every change
    std::optional<Field> field;          ///< nothing: an empty scene
    std::vector<DrawnSurface> surfaces;  ///< the felt one first
    Look look;
    Vec3 crosshair = Vec3::Zero();  ///< [mm, physical]
    Colour background;
    Colour ink;  ///< of lines
    pictures::Camera camera;
    int width = 1, height = 1;  ///< [device pixels]
    double pixel_ratio = 1;     ///< device pixels a logical pixel
    bool moving = false;        ///< quick rather than fine
};

/// What a render thread has drawn.
struct RenderedImage {
    std::uint64_t number = 0;
    int width = 0, height = 0;  ///< as asked for, or half of it while things move slowly
    pictures::Camera camera;
    double reach = 1;  ///< [mm] see reach_of(), of the volume that is shown
    pictures::Layer solid;
    /// What is translucent, with its opacity as alpha. Empty without any.
    pictures::Layer glass;
    bool moving = false;
    double seconds = 0;     ///< that it took
    bool hardware = false;  ///< drawn by graphics hardware, not by the processor
};

/// Draws the newest request. To be used on the window's thread.
class Painter {
  public:
    /// Called on any thread.
    struct Results {
        std::function<void(RenderedImage)> drawn;
        std::function<void(std::string what)> failed;
    };
    /// With low priority other threads go first.
    enum class Priority { normal, low };

    Painter() = default;
    Painter(const Painter&) = delete;
    Painter& operator=(const Painter&) = delete;
    virtual ~Painter() = default;

    /// Draws this one next; a request that still waits is dropped.
    virtual void draw(RenderRequest request) = 0;
    /// Drops a waiting request and cancels the present one; neither gives an image.
    virtual void give_up() = 0;
};

using MakePainter =
    std::function<std::unique_ptr<Painter>(Painter::Priority priority, Painter::Results results)>;

/// Draws on a thread with an OpenGL context of its own: what the program uses. To be called on the
/// window's thread; results come on the other one.
std::unique_ptr<Painter> make_render_thread(Painter::Priority priority, Painter::Results results);
/// True if OpenGL's renderer of this name (GL_RENDERER) is the machine's graphics hardware.
bool is_hardware(const std::string& renderer_name);

}  // namespace palpate::viewer
