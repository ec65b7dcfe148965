// Rows of slices on several threads, by oneTBB.
#include "filters/rows.hpp"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>

namespace palpate::filters {

ForRows rows_in_parallel(int threads, int width) {
    const int cores = tbb::info::default_concurrency();  // of more, oneTBB would complain
    const auto arena =
        std::make_shared<tbb::task_arena>(threads == 0 ? cores : std::min(threads, cores));
    const int rows = std::max(1, grain / width);
    return [arena, rows](int count, const std::function<void(int, int)>& work) {
        if (count <= rows || arena->max_concurrency() == 1) return work(0, count);
        arena->execute([&] {
            tbb::parallel_for(
                tbb::blocked_range<int>(0, count, std::size_t(rows)),
                [&](const tbb::blocked_range<int>& range) { work(range.begin(), range.end()); },
                tbb::simple_partitioner());
        });
    };
}

}  // namespace palpate::filters
