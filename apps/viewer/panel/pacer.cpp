// Holding wishes back.
#include "apps/viewer/panel/pacer.hpp"

#include <utility>

namespace palpate::viewer {

Pacer::Pacer(QObject* parent, int interval) : QObject(parent) {
    timer_.setSingleShot(true);
    timer_.setInterval(interval);
    timer_.setTimerType(Qt::PreciseTimer);
    connect(&timer_, &QTimer::timeout, this, &Pacer::pass);
}

void Pacer::put(std::function<void()> wish) {
    waiting_ = std::move(wish);
    if (timer_.isActive()) return;
    if (!since_.isValid() || since_.elapsed() >= timer_.interval()) {
        pass();
    } else {
        timer_.start();
    }
}

void Pacer::flush() {
    if (waiting_) pass();
}

void Pacer::drop() {
    timer_.stop();
    waiting_ = nullptr;
}

void Pacer::pass() {
    timer_.stop();
    since_.start();
    if (const auto wish = std::exchange(waiting_, nullptr)) wish();
}

}  // namespace palpate::viewer
