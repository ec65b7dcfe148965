// Rows of slices on several threads, by the standard library: for Windows there is no oneTBB here.
#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "filters/rows.hpp"

namespace palpate::filters {

/// The work throws nothing: it computes in memory that is there.
ForRows rows_in_parallel(int threads, int width) {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const int team = threads == 0 ? cores : std::min(threads, cores);
    const int rows = std::max(1, grain / width);
    return [team, rows](int count, const std::function<void(int, int)>& work) {
        if (count <= rows || team == 1) return work(0, count);
        std::atomic<int> next{0};
        const auto take_pieces = [&] {
            for (int i = next.fetch_add(rows); i < count; i = next.fetch_add(rows)) {
                work(i, std::min(i + rows, count));
            }
        };
        std::vector<std::jthread> others;
        for (int i = 1; i < team; ++i) others.emplace_back(take_pieces);
        take_pieces();
    };
}

}  // namespace palpate::filters
