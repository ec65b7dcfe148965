// Threads: one that runs a long task with progress, which can be cancelled, and as many as there
// are processors for a task in pieces.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "palpate/io/volume_file.hpp"

namespace palpate::viewer {

/// Runs one task. The task writes its result where the owner finds it, who must not read it before
/// ended(). The destructor cancels the task and waits for the thread.
class Worker {
  public:
    /// Gets a progress function that throws once the task was cancelled.
    using Task = std::function<void(const io::Progress& progress)>;

    /// Starts. `changed` is called from the thread after each percent of progress and at the end:
    /// it must only wake the owner.
    Worker(Task task, std::function<void()> changed);

    double progress() const noexcept { return progress_.load(std::memory_order_relaxed); }
    /// The task stops at its next progress.
    void cancel() noexcept { thread_.request_stop(); }
    bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }
    /// Of a task that has ended: true if it is done, false if it was cancelled. Throws what the
    /// task has thrown.
    bool finish() const;

  private:
    void run(const std::stop_token& stop, const Task& task,
             const std::function<void()>& changed) noexcept;

    std::atomic<double> progress_{0};
    std::atomic<bool> ended_{false};
    bool done_ = false;  // before ended_
    std::exception_ptr error_;
    std::jthread thread_;
};

/// The newest of several tasks. Earlier ones are cancelled, but may notice it late, for example
/// when a disk hangs: only the destructor waits for them.
class NewestWorker {
  public:
    void start(Worker::Task task, std::function<void()> changed);
    void cancel();
    /// False after cancel(), too.
    bool ended() const { return newest_ && newest_->ended(); }

  private:
    std::unique_ptr<Worker> newest_;
    std::vector<std::unique_ptr<Worker>> cancelled_;
};

/// work(item) for all of them, until one says no. Threads keep the caller's priority. False if one
/// said no. Throws what one of them throws.
bool for_each_at_once(const std::vector<std::size_t>& items,
                      const std::function<bool(std::size_t)>& work);

}  // namespace palpate::viewer
