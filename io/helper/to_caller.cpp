// Shared by a reader in the helper program and its caller: samples, progress, limits on memory.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "io/helper/child.hpp"
#include "io/helper/decode.hpp"
#include "io/helper/protocol.hpp"
#include "io/helper/report.hpp"

namespace palpate::io {

void* memory_of_caller(std::uint64_t bytes) {
    if (ftruncate(samples_descriptor, static_cast<off_t>(bytes)) != 0) return nullptr;
    void* at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, samples_descriptor, 0);
    return at == MAP_FAILED ? nullptr : at;
}

std::span<std::byte> shared_samples(std::uint64_t bytes) {
    void* at = memory_of_caller(bytes);
    if (!at) {
        throw Failure("no memory for " + text_of(static_cast<double>(bytes) / 1e9) +
                      " GB of samples; use a smaller volume");
    }
    return {static_cast<std::byte*>(at), bytes};
}

std::uint64_t bound_memory([[maybe_unused]] std::uint64_t more) {
    rlimit limit{};
    getrlimit(RLIMIT_DATA, &limit);
    const std::uint64_t before = limit.rlim_cur;
#ifndef PALPATE_SANITIZED
    // The sixth number of statm: pages of data and stack.
    std::ifstream statm("/proc/self/statm");
    std::uint64_t pages = 0;
    for (int i = 0; i < 6; ++i) statm >> pages;
    const auto now = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
    if (!statm || more > UINT64_MAX / 4) return before;
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, now + more + (rlim_t{64} << 20));
    setrlimit(RLIMIT_DATA, &limit);
#endif
    return before;
}

MemoryBound::~MemoryBound() {
    rlimit limit{};
    getrlimit(RLIMIT_DATA, &limit);
    limit.rlim_cur = before_;
    setrlimit(RLIMIT_DATA, &limit);
}

void say_progress(double fraction) {
    report({{"progress", fraction}});
}
void say_doing(const std::string& what) {
    report({{"doing", what}});
}

}  // namespace palpate::io
