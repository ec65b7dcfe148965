// Counts what the program asks of the heap. Link allocation_counter.cpp, once a program: it
// replaces the global operator new.
#pragma once

#include <cstdint>

namespace palpate::support {

/// Calls of operator new so far, by all threads.
std::int64_t allocation_count();
/// The same by the calling thread alone.
std::int64_t thread_allocation_count();

}  // namespace palpate::support
