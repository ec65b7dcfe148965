// Each hand has a thread while its device may have to be waited for.
#include "apps/viewer/model/run_closer.hpp"

#include <exception>
#include <system_error>
#include <utility>

namespace palpate::viewer {
namespace {

constexpr std::chrono::milliseconds between_looks{2};

/// On a thread of its own, or at once if the system gives none.
template <class Work>
void start(std::vector<std::jthread>& threads, const Work& work) {
    try {
        threads.emplace_back(work);
    } catch (const std::system_error&) {
        work();
    }
}

/// work(run) for all of them at once.
template <class Work>
void for_each_hand(std::vector<std::unique_ptr<run::Run>>& runs, const Work& work) {
    std::vector<std::jthread> threads;
    for (auto& run : runs) start(threads, [&work, &run] { work(run); });
}

/// Waits until none is left, at most for this time. False if some are.
bool reaches_zero(const std::atomic<int>& count, std::chrono::milliseconds time,
                  const std::function<void()>& wait) {
    const auto latest = std::chrono::steady_clock::now() + time;
    while (count > 0 && std::chrono::steady_clock::now() < latest) {
        if (wait) wait();
        std::this_thread::sleep_for(between_looks);
    }
    return count == 0;
}

}  // namespace

/// What close() was called with.
struct RunCloser::Job {
    std::vector<std::unique_ptr<run::Run>> runs;
    std::function<void(const Ended&)> ended;
    std::function<void()> closed;
};

void RunCloser::carry_out(Job& job) {
    for_each_hand(job.runs, [](const auto& run) { run->stop(); });
    --forces_;
    Ended how;
    for (const auto& run : job.runs) {
        how.recorded = how.recorded || run->recording();
        try {
            run->stop_recording();
        } catch (const std::exception& error) {
            how.lost = error.what();
        }
        if (how.unanswered.empty()) how.unanswered = run->unanswered();
    }
    if (job.ended) job.ended(how);
    --recording_;
    for_each_hand(job.runs, [](auto& run) { run.reset(); });
    if (job.closed) job.closed();
    --open_;
}

void RunCloser::close(std::vector<std::unique_ptr<run::Run>> runs,
                      std::function<void(const Ended&)> ended, std::function<void()> closed) {
    const std::lock_guard lock(mutex_);
    if (open_ == 0) threads_.clear();
    ++open_;
    ++recording_;
    ++forces_;
    const auto job = std::make_shared<Job>(std::move(runs), std::move(ended), std::move(closed));
    start(threads_, [this, job] { carry_out(*job); });
}

bool RunCloser::forces_end_within(std::chrono::milliseconds time) const {
    return reaches_zero(forces_, time, {});
}

void RunCloser::wait_for_recordings() const {
    while (recording_ > 0) std::this_thread::sleep_for(between_looks);
}

bool RunCloser::closes_within(std::chrono::milliseconds time,
                              const std::function<void()>& wait) const {
    return reaches_zero(open_, time, wait);
}

}  // namespace palpate::viewer
