// Pieces of work on several threads. parallel.cpp by oneTBB, parallel_windows.cpp by the standard
// library.
#pragma once

#include <functional>

namespace palpate::filters {

/// Calls work(i) for i from 0 to count - 1, several at the same time. Returns when all are done.
using Parallel = std::function<void(int count, const std::function<void(int)>& work)>;

/// On `threads` threads (0, and at most: as many as there are processors).
Parallel in_parallel(int threads);

}  // namespace palpate::filters
