// Ends live runs without keeping the window waiting.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "palpate/run/run.hpp"

namespace palpate::viewer {

/// Closes runs on threads of its own: a driver may not answer, and the reader of a recording may be
/// slow. The destructor waits for all of them.
class RunCloser {
  public:
    /// Of runs whose forces have ended, and whose recordings are complete.
    struct Ended {
        bool recorded = false;   ///< at least one of them was being recorded
        std::string lost;        ///< why a recording is not complete; usually empty
        std::string unanswered;  ///< as run::Run::unanswered() of one of them; usually empty
    };

    /// Forces go to zero at once, recordings are completed, and devices closed. `ended` is called
    /// from a thread before devices are closed, `closed` after that; both may be empty. Any thread.
    void close(std::vector<std::unique_ptr<run::Run>> runs,
               std::function<void(const Ended&)> ended = {}, std::function<void()> closed = {});

    /// Waits until all forces have ended (run::Run::stop()), at most for this time. False if some
    /// have not.
    bool forces_end_within(std::chrono::milliseconds time) const;
    /// Waits until all recordings have ended.
    void wait_for_recordings() const;
    /// Waits until all devices are closed, at most for this time. False if some are not. Any
    /// thread. `wait` is called meanwhile, every few milliseconds, and may throw.
    bool closes_within(std::chrono::milliseconds time,
                       const std::function<void()>& wait = {}) const;

  private:
    struct Job;
    void carry_out(Job& job);

    // Calls of close() whose runs still have a force, a recording, a device.
    std::atomic<int> forces_{0}, recording_{0}, open_{0};
    std::mutex mutex_;
    std::vector<std::jthread> threads_;
};

}  // namespace palpate::viewer
