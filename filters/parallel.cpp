// Pieces of work on several threads: each thread takes the next piece that is not taken yet.
#include "filters/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace palpate::filters {

Parallel in_parallel(int threads) {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const int most = threads == 0 ? cores : std::min(threads, cores);
    return [most](int count, const std::function<void(int)>& work) {
        std::atomic<int> next{0};
        const auto team = static_cast<std::size_t>(std::max(1, std::min(most, count)));
        std::vector<std::exception_ptr> thrown(team);
        const auto take_pieces = [&](std::size_t number) {
            try {
                for (int i = next++; i < count; i = next++) work(i);
            } catch (...) {
                thrown[number] = std::current_exception();
                next = count;
            }
        };
        {
            std::vector<std::jthread> others;
            try {
                for (std::size_t i = 1; i < team; ++i) others.emplace_back(take_pieces, i);
            } catch (const std::system_error&) {  // no more threads: those that there are do it
            }
            take_pieces(0);
        }
        for (const auto& one : thrown) {
            if (one) std::rethrow_exception(one);
        }
    };
}

}  // namespace palpate::filters
