// Each hand has a thread while its device may have to be waited for.
#include "apps/viewer/model/run_closer.hpp"

#include <utility>

#include "palpate/io/error.hpp"

namespace palpate::viewer {
namespace {

constexpr std::chrono::milliseconds between_looks{2};

/// work(run) for all of them at once.
template <class Work>
void for_each_hand(std::vector<std::unique_ptr<run::Run>>& runs, Work work) {
    std::vector<std::jthread> threads;
    for (auto& run : runs) threads.emplace_back([&work, &run] { work(run); });
}

}  // namespace

void RunCloser::end(std::vector<std::unique_ptr<run::Run>>& runs, Ended& ended) {
    for_each_hand(runs, [](const auto& run) { run->stop(); });
    for (const auto& run : runs) {
        ended.recorded = ended.recorded || run->recording();
        try {
            run->stop_recording();
        } catch (const io::OutputError& error) {
            ended.lost = error.what();
        }
        if (ended.unanswered.empty()) ended.unanswered = run->unanswered();
    }
}

void RunCloser::close(std::vector<std::unique_ptr<run::Run>> runs,
                      std::function<void(const Ended&)> ended, std::function<void()> closed) {
    if (open_ == 0) threads_.clear();
    ++open_;
    ++recording_;
    threads_.emplace_back([this, runs = std::move(runs), ended = std::move(ended),
                           closed = std::move(closed)]() mutable {
        Ended how;
        end(runs, how);
        ended(how);
        --recording_;
        for_each_hand(runs, [](auto& run) { run.reset(); });
        if (closed) closed();
        --open_;
    });
}

void RunCloser::wait_for_recordings() const {
    while (recording_ > 0) std::this_thread::sleep_for(between_looks);
}

bool RunCloser::closes_within(std::chrono::milliseconds time,
                              const std::function<void()>& wait) const {
    const auto latest = std::chrono::steady_clock::now() + time;
    while (open_ > 0 && std::chrono::steady_clock::now() < latest) {
        if (wait) wait();
        std::this_thread::sleep_for(between_looks);
    }
    return open_ == 0;
}

}  // namespace palpate::viewer
