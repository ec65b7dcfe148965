// Runs an offscreen renderer on a thread. Qt wants the context made in the window's thread and
// moved.
#include "apps/viewer/scene/render_thread.hpp"

#include <QVTKOpenGLNativeWidget.h>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLFunctions>

#include <exception>
#include <utility>

#include "apps/viewer/scene/offscreen_renderer.hpp"
#include "apps/viewer/scene/thread_priority.hpp"

namespace palpate::viewer {

bool is_hardware(const std::string& name) {
    for (const char* software : {"llvmpipe", "softpipe", "swr", "SWR", "Software", "software"}) {
        if (name.find(software) != std::string::npos) return false;
    }
    return !name.empty();
}

RenderThread::RenderThread(Priority priority, Results results)
    : priority_(priority),
      results_(std::move(results)),
      surface_(std::make_unique<QOffscreenSurface>()),
      context_(std::make_unique<QOpenGLContext>()) {
    QSurfaceFormat format = QVTKOpenGLNativeWidget::defaultFormat();
    format.setSamples(0);
    surface_->setFormat(format);
    surface_->create();
    context_->setFormat(format);
    context_->create();
    thread_.reset(QThread::create([this] { run(); }));
    context_->moveToThread(thread_.get());
    thread_->start();
}

RenderThread::~RenderThread() {
    give_up();
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    thread_->wait();
}

void RenderThread::draw(RenderRequest request) {
    {
        const std::lock_guard lock(mutex_);
        next_ = std::move(request);
    }
    changed_.notify_all();
}

void RenderThread::give_up() {
    const std::lock_guard lock(mutex_);
    next_.reset();
    give_up_ = true;
}

void RenderThread::run() {
    if (priority_ == Priority::low) lower_thread_priority();
    if (!context_->makeCurrent(surface_.get())) {
        results_.failed("the 3-D view gets no OpenGL context");
        context_.reset();
        return;
    }
    try {
        const GLubyte* const name = context_->functions()->glGetString(GL_RENDERER);
        OffscreenRenderer renderer(give_up_,
                                   name && is_hardware(reinterpret_cast<const char*>(name)));
        for (;;) {
            RenderRequest request;
            {
                std::unique_lock lock(mutex_);
                changed_.wait(lock, [this] { return stopping_ || next_; });
                if (stopping_) break;
                request = std::move(*next_);
                next_.reset();
                give_up_ = false;
            }
            std::optional<RenderedImage> image = renderer.draw(request);
            if (image) results_.drawn(std::move(*image));
        }
    } catch (const std::exception& error) {
        results_.failed(error.what());
    }
    context_->doneCurrent();
    context_.reset();
}

std::unique_ptr<Painter> make_render_thread(Painter::Priority priority, Painter::Results results) {
    return std::make_unique<RenderThread>(priority, std::move(results));
}

}  // namespace palpate::viewer
