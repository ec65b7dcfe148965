// Draws render requests and hands the images over; the scene does not know how. No VTK.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "apps/viewer/scene/render_request.hpp"

namespace palpate::viewer {

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

/// Makes a painter of a scene.
using MakePainter =
    std::function<std::unique_ptr<Painter>(Painter::Priority priority, Painter::Results results)>;

/// A RenderThread: what the program uses.
std::unique_ptr<Painter> make_render_thread(Painter::Priority priority, Painter::Results results);

}  // namespace palpate::viewer
