// A thread that draws shots with an OpenGL context of its own, so that the window never waits for
// a picture.
#pragma once

#include <QThread>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "apps/viewer/scene/shot.hpp"

class QOffscreenSurface;
class QOpenGLContext;

namespace palpate::viewer {

/// True if OpenGL's renderer of this name (GL_RENDERER) is the machine's graphics hardware.
bool is_hardware(const std::string& renderer_name);

class Painter {
  public:
    /// Called from the painting thread.
    struct Results {
        std::function<void(Backdrop)> painted;
        std::function<void(std::string what)> failed;
    };
    enum class Pace { prompt, patient };
    /// From the window's thread. A patient painter stands back behind other threads.
    Painter(Pace pace, Results results);
    /// Gives up what is under way and waits for the thread.
    ~Painter();
    Painter(const Painter&) = delete;
    Painter& operator=(const Painter&) = delete;

    /// Paints this one next; one that still waits is forgotten.
    void paint(Shot shot);
    /// Forgets what waits and gives up what is under way; nothing comes of it.
    void give_up();

  private:
    void run();

    Pace pace_;
    Results results_;
    std::unique_ptr<QOffscreenSurface> surface_;
    std::unique_ptr<QOpenGLContext> context_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<Shot> next_;
    bool stopping_ = false;
    std::atomic<bool> give_up_{false};
    std::unique_ptr<QThread> thread_;
};

}  // namespace palpate::viewer
