// The painter of the program: a thread that draws with an OpenGL context of its own, so that the
// window never waits for an image.
#pragma once

#include <QThread>

#include <atomic>
#include <condition_variable>
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

class RenderThread final : public Painter {
  public:
    /// To be called on the window's thread. Results come on the render thread.
    RenderThread(Priority priority, Results results);
    /// Cancels the present request and waits for the thread.
    ~RenderThread() override;

    void draw(RenderRequest request) override;
    void give_up() override;

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
