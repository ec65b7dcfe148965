// A thread that draws render requests with an OpenGL context of its own, so that the window never
// waits for an image.
#pragma once

#include <QThread>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "apps/viewer/scene/render_request.hpp"

class QOffscreenSurface;
class QOpenGLContext;

namespace palpate::viewer {

/// True if OpenGL's renderer of this name (GL_RENDERER) is the machine's graphics hardware.
bool is_hardware(const std::string& renderer_name);

class RenderThread {
  public:
    /// Called on the render thread.
    struct Results {
        std::function<void(RenderedImage)> drawn;
        std::function<void(std::string what)> failed;
    };
    enum class Priority { normal, low };
    /// To be called on the window's thread. With low priority other threads go first.
    RenderThread(Priority priority, Results results);
    /// Cancels the present request and waits for the thread.
    ~RenderThread();

    /// Draws this one next; a request that still waits is dropped.
    void draw(RenderRequest request);
    /// Drops a waiting request and cancels the present one; neither gives an image.
    void give_up();

  private:
    void run();

    Priority priority_;
    Results results_;
    std::unique_ptr<QOffscreenSurface> surface_;
    std::unique_ptr<QOpenGLContext> context_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<RenderRequest> next_;
    bool stopping_ = false;
    std::atomic<bool> give_up_{false};
    std::unique_ptr<QThread> thread_;
};

}  // namespace palpate::viewer
