// Pieces of work on several threads, by the standard library: for Windows there is no oneTBB here.
#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "filters/parallel.hpp"

namespace palpate::filters {

/// The work throws nothing: it computes in memory that is there.
Parallel in_parallel(int threads) {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const int team = threads == 0 ? cores : std::min(threads, cores);
    return [team](int count, const std::function<void(int)>& work) {
        std::atomic<int> next{0};
        const auto take_pieces = [&] {
            for (int i = next++; i < count; i = next++) work(i);
        };
        std::vector<std::jthread> others;
        for (int i = 1; i < std::min(team, count); ++i) others.emplace_back(take_pieces);
        take_pieces();
    };
}

}  // namespace palpate::filters
