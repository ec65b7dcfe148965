// Replaces the global operators new and delete by ones that count and can fail. See
// allocation_counter.hpp.
#include "support/allocation_counter.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::int64_t> count{0};
std::atomic<std::size_t> denied_from{0}, denied_to{0};
thread_local std::int64_t thread_count = 0;
thread_local std::int64_t thread_frees = 0;

void* counted(std::size_t size) noexcept {
    count.fetch_add(1, std::memory_order_relaxed);
    ++thread_count;
    if (size >= denied_from && size < denied_to) return nullptr;
    return std::malloc(size == 0 ? 1 : size);
}

void* counted(std::size_t size, std::align_val_t alignment) noexcept {
    count.fetch_add(1, std::memory_order_relaxed);
    ++thread_count;
    // Not every C library has aligned_alloc: the block that holds the memory is noted before it.
    const auto a = std::max(static_cast<std::size_t>(alignment), alignof(void*));
    void* const block = std::malloc(sizeof(void*) + a + size);
    if (!block) return nullptr;
    const auto first = reinterpret_cast<std::uintptr_t>(block) + sizeof(void*);
    void** const memory = reinterpret_cast<void**>((first + a - 1) / a * a);
    memory[-1] = block;
    return memory;
}

void give_back(void* memory) noexcept {
    thread_frees += memory != nullptr;
    std::free(memory);
}

void give_back(void* memory, std::align_val_t) noexcept {
    give_back(memory ? static_cast<void**>(memory)[-1] : nullptr);
}

void* or_throw(void* memory) {
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

namespace palpate::support {

std::int64_t allocation_count() {
    return count.load();
}

std::int64_t thread_allocation_count() {
    return thread_count;
}

std::int64_t thread_free_count() {
    return thread_frees;
}

DeniedAllocations::DeniedAllocations(std::size_t from, std::size_t to) {
    denied_from = from;
    denied_to = to;
}
DeniedAllocations::~DeniedAllocations() {
    denied_to = 0;
}

}  // namespace palpate::support

// The array forms of the standard library call these; the address sanitizer has nothrow forms of
// its own.
void* operator new(std::size_t size) {
    return or_throw(counted(size));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return or_throw(counted(size, alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return counted(size);
}
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    return counted(size, alignment);
}
void operator delete(void* memory) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    give_back(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::align_val_t alignment) noexcept {
    give_back(memory, alignment);
}
void operator delete(void* memory, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    give_back(memory, alignment);
}
void operator delete(void* memory, std::size_t, std::align_val_t alignment) noexcept {
    give_back(memory, alignment);
}
