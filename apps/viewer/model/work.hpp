// Long work in a thread of its own, with progress, that can be given up.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <thread>

#include "palpate/io/volume_file.hpp"

namespace palpate::viewer {

/// One piece of work. Its result is what the task writes to where its owner finds it: not before
/// ended(). Destroying it gives the work up and waits for the thread.
class Work {
  public:
    /// Gets a progress function that throws once the work was given up.
    using Task = std::function<void(const io::Progress& progress)>;

    /// Starts. `changed` is called from the thread, whenever progress was made (not more often than
    /// each percent) and as its last act: it must only wake its owner.
    Work(Task task, std::function<void()> changed);
    ~Work();
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

    double progress() const noexcept { return progress_.load(std::memory_order_relaxed); }
    /// The task stops at its next progress.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }
    /// Of work that has ended: true if it is done, false if it was given up. Throws what the task
    /// has thrown.
    bool finish() const;

  private:
    struct GivenUp {};
    void run(const Task& task, const std::function<void()>& changed) noexcept;

    std::atomic<double> progress_{0};
    std::atomic<bool> cancelled_{false}, ended_{false};
    bool done_ = false;  // before ended_
    std::exception_ptr error_;
    std::jthread thread_;
};

}  // namespace palpate::viewer
