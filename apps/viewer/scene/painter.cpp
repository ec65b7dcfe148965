// Painting thread. Its context is made with the window's thread and moved, as Qt wants it.
#include "apps/viewer/scene/painter.hpp"

#include <QVTKOpenGLNativeWidget.h>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLFunctions>

#include <exception>

#include "apps/viewer/scene/patience.hpp"
#include "apps/viewer/scene/stage.hpp"

namespace palpate::viewer {

bool is_hardware(const std::string& name) {
    for (const char* software : {"llvmpipe", "softpipe", "swr", "SWR", "Software", "software"}) {
        if (name.find(software) != std::string::npos) return false;
    }
    return !name.empty();
}

Painter::Painter(Pace pace, Results results)
    : pace_(pace),
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

Painter::~Painter() {
    give_up();
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    thread_->wait();
}

void Painter::paint(Shot shot) {
    {
        const std::lock_guard lock(mutex_);
        next_ = std::move(shot);
    }
    changed_.notify_all();
}

void Painter::give_up() {
    const std::lock_guard lock(mutex_);
    next_.reset();
    give_up_ = true;
}

void Painter::run() {
    if (pace_ == Pace::patient) stand_back();
    if (!context_->makeCurrent(surface_.get())) {
        results_.failed("the 3-D view gets no OpenGL context");
        context_.reset();
        return;
    }
    try {
        const GLubyte* const name = context_->functions()->glGetString(GL_RENDERER);
        Stage stage(give_up_, name && is_hardware(reinterpret_cast<const char*>(name)));
        for (;;) {
            Shot shot;
            {
                std::unique_lock lock(mutex_);
                changed_.wait(lock, [this] { return stopping_ || next_; });
                if (stopping_) break;
                shot = std::move(*next_);
                next_.reset();
                give_up_ = false;
            }
            std::optional<Backdrop> backdrop = stage.draw(shot);
            if (backdrop) results_.painted(std::move(*backdrop));
        }
    } catch (const std::exception& error) {
        results_.failed(error.what());
    }
    context_->doneCurrent();
    context_.reset();
}

}  // namespace palpate::viewer
