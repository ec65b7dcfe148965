// Counts heap allocations, or lets some of them fail. Link allocation_counter.cpp once per program;
// it replaces the global operators new and delete.
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate::support {

/// Calls of operator new so far, by all threads.
std::int64_t allocation_count();
/// The same by the calling thread alone.
std::int64_t thread_allocation_count();
/// Calls of operator delete by the calling thread that had something to free.
std::int64_t thread_free_count();
/// While there is one, those of at least `from` and less than `to` bytes throw std::bad_alloc, in
/// all threads.
class DeniedAllocations {
  public:
    DeniedAllocations(std::size_t from, std::size_t to);
    ~DeniedAllocations();
    DeniedAllocations(const DeniedAllocations&) = delete;
    DeniedAllocations& operator=(const DeniedAllocations&) = delete;
};

}  // namespace palpate::support
