// Pieces of work on several threads, by the standard library.
#pragma once

#include <functional>

namespace palpate::filters {

/// Calls work(i) for i from 0 to count - 1, several at the same time. Returns when all are done, or
/// throws what a piece has thrown.
using Parallel = std::function<void(int count, const std::function<void(int)>& work)>;

/// On `threads` threads (0, and at most: as many as there are processors).
Parallel in_parallel(int threads);

}  // namespace palpate::filters
