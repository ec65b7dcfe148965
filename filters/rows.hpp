// Rows of slices on several threads. rows.cpp by oneTBB, rows_windows.cpp by the standard library.
#pragma once

#include "filters/round.hpp"

namespace palpate::filters {

/// Samples in a piece of work: some 50 us.
inline constexpr int grain = 16384;

/// Rows of slices of `width` samples, on `threads` threads (0, and at most: as many as there are
/// processors) or, if they are few, on the calling one.
ForRows rows_in_parallel(int threads, int width);

}  // namespace palpate::filters
