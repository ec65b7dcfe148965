// Counts heap allocations. Link allocation_counter.cpp once per program; it replaces the global
// operators new and delete.
#pragma once

#include <cstdint>

namespace palpate::support {

/// Calls of operator new so far, by all threads.
std::int64_t allocation_count();
/// The same by the calling thread alone.
std::int64_t thread_allocation_count();
/// Calls of operator delete by the calling thread that had something to free.
std::int64_t thread_free_count();

}  // namespace palpate::support
