// Holds requests back until the interval since the last one is over.
#include "apps/viewer/panel/rate_limiter.hpp"

#include <utility>

namespace palpate::viewer {

RateLimiter::RateLimiter(QObject* parent, int interval) : QObject(parent), timer_(this) {
    timer_.setSingleShot(true);
    timer_.setInterval(interval);
    timer_.setTimerType(Qt::PreciseTimer);
    connect(&timer_, &QTimer::timeout, this, &RateLimiter::pass);
}

void RateLimiter::put(std::function<void()> request) {
    waiting_ = std::move(request);
    if (timer_.isActive()) return;
    if (!since_.isValid() || since_.elapsed() >= timer_.interval()) {
        pass();
    } else {
        timer_.start();
    }
}

void RateLimiter::flush() {
    if (waiting_) pass();
}

void RateLimiter::drop() {
    timer_.stop();
    waiting_ = nullptr;
}

void RateLimiter::pass() {
    timer_.stop();
    since_.start();
    if (const auto request = std::exchange(waiting_, nullptr)) request();
}

}  // namespace palpate::viewer
