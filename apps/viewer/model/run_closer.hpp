// Ends live runs without keeping the window waiting.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
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
    /// from a thread before devices are closed, `closed` after that.
    void close(std::vector<std::unique_ptr<run::Run>> runs, std::function<void(const Ended&)> ended,
               std::function<void()> closed = {});

    /// Waits until all recordings have ended.
    void wait_for_recordings() const;
    /// Waits so long at most until all devices are closed. Any thread. `wait` is called meanwhile,
    /// every few milliseconds, and may throw.
    bool closes_within(std::chrono::milliseconds time,
                       const std::function<void()>& wait = {}) const;

  private:
    static void end(std::vector<std::unique_ptr<run::Run>>& runs, Ended& ended);

    std::atomic<int> open_{0}, recording_{0};  // times close() was called whose runs are so still
    std::vector<std::jthread> threads_;
};

}  // namespace palpate::viewer
