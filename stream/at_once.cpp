// Pieces of work on several threads. See the header.
#include "stream/at_once.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "palpate/stream/store.hpp"
#include "stream/small_threads.hpp"

namespace palpate::stream {

void for_all_at_once(std::size_t count, int threads, const std::stop_token& stop,
                     const std::function<void(std::size_t i, const std::stop_token& until)>& work) {
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::exception_ptr problem;
    std::stop_source until;
    const std::stop_callback with(stop, [&] { until.request_stop(); });
    const auto run = [&] {
        try {
            for (std::size_t i = next++; i < count && !until.stop_requested(); i = next++) {
                work(i, until.get_token());
            }
        } catch (...) {
            {
                const std::scoped_lock lock(mutex);
                if (!problem) problem = std::current_exception();
            }
            until.request_stop();
        }
    };
    {
        const auto most = std::clamp<std::size_t>(count, 1, std::size_t(threads));
        const SmallThreads others(int(most) - 1, [&](const std::stop_token&) { run(); });
        run();
    }
    if (problem) std::rethrow_exception(problem);
    if (until.stop_requested()) throw Cancelled{};
}

}  // namespace palpate::stream
