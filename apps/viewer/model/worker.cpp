// The thread of a task.
#include "apps/viewer/model/worker.hpp"

#include <utility>

namespace palpate::viewer {
namespace {

struct Cancelled {};

}  // namespace

Worker::Worker(Task task, std::function<void()> changed)
    : thread_([this, task = std::move(task), changed = std::move(changed)](
                  const std::stop_token& stop) { run(stop, task, changed); }) {}

void Worker::run(const std::stop_token& stop, const Task& task,
                 const std::function<void()>& changed) noexcept {
    try {
        task([&](double fraction) {
            if (stop.stop_requested()) throw Cancelled{};
            const bool far = fraction >= progress() + 0.01;
            if (!far && fraction < 1) return;
            progress_.store(fraction, std::memory_order_relaxed);
            changed();
        });
        done_ = true;
    } catch (const Cancelled&) {
    } catch (...) {
        error_ = std::current_exception();
    }
    ended_.store(true, std::memory_order_release);
    changed();
}

bool Worker::finish() const {
    if (error_) std::rethrow_exception(error_);
    return done_;
}

void NewestWorker::start(Worker::Task task, std::function<void()> changed) {
    cancel();
    newest_ = std::make_unique<Worker>(std::move(task), std::move(changed));
}

void NewestWorker::cancel() {
    std::erase_if(cancelled_, [](const auto& worker) { return worker->ended(); });
    if (!newest_) return;
    newest_->cancel();
    cancelled_.push_back(std::move(newest_));
}

}  // namespace palpate::viewer
