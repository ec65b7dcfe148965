// Pieces of work on several threads, by oneTBB.
#include "filters/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>

namespace palpate::filters {

Parallel in_parallel(int threads) {
    const int cores = tbb::info::default_concurrency();  // of more, oneTBB would complain
    const auto arena =
        std::make_shared<tbb::task_arena>(threads == 0 ? cores : std::min(threads, cores));
    return [arena](int count, const std::function<void(int)>& work) {
        arena->execute([&] {
            tbb::parallel_for(
                tbb::blocked_range<int>(0, count),
                [&](const tbb::blocked_range<int>& range) {
                    for (int i = range.begin(); i < range.end(); ++i) work(i);
                },
                tbb::simple_partitioner());
        });
    };
}

}  // namespace palpate::filters
