// Runs tasks on threads.
#include "apps/viewer/model/worker.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
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

bool for_each_at_once(const std::vector<std::size_t>& items,
                      const std::function<bool(std::size_t)>& work) {
    std::atomic<std::size_t> next{0};
    std::atomic<bool> stopped{false};
    std::mutex mutex;
    std::exception_ptr error;
    const auto run = [&] {
        try {
            for (std::size_t i = next++; i < items.size() && !stopped; i = next++) {
                if (!work(items[i])) stopped = true;
            }
        } catch (...) {
            const std::lock_guard lock(mutex);
            error = std::current_exception();
            stopped = true;
        }
    };
    {
        const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
        std::vector<std::jthread> threads;
        for (std::size_t t = 1; t < std::min(processors, items.size()); ++t) {
            threads.emplace_back(run);
        }
        run();
    }
    if (error) std::rethrow_exception(error);
    return !stopped;
}

}  // namespace palpate::viewer
