// Threads that take items in turn.
#include "apps/viewer/model/at_once.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

namespace palpate::viewer {

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
