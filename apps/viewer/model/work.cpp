// The thread of a piece of work.
#include "apps/viewer/model/work.hpp"

#include <utility>

namespace palpate::viewer {

Work::Work(Task task, std::function<void()> changed)
    : thread_(
          [this, task = std::move(task), changed = std::move(changed)] { run(task, changed); }) {}

Work::~Work() {
    cancel();
}

void Work::run(const Task& task, const std::function<void()>& changed) noexcept {
    try {
        task([&](double fraction) {
            if (cancelled_.load(std::memory_order_relaxed)) throw GivenUp{};
            const bool far = fraction >= progress_.load(std::memory_order_relaxed) + 0.01;
            if (!far && fraction < 1) return;
            progress_.store(fraction, std::memory_order_relaxed);
            changed();
        });
        done_ = true;
    } catch (const GivenUp&) {  // as asked
    } catch (...) {
        error_ = std::current_exception();
    }
    ended_.store(true, std::memory_order_release);
    changed();
}

bool Work::finish() const {
    if (error_) std::rethrow_exception(error_);
    return done_;
}

}  // namespace palpate::viewer
