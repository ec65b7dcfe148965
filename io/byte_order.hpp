// The order of the bytes in a sample.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace palpate::io {

/// Turns the bytes of each sample round; `each`: bytes of one sample.
inline void swap_bytes(std::span<std::byte> samples, std::size_t each) {
    for (std::size_t at = 0; each > 1 && at + each <= samples.size(); at += each) {
        std::reverse(samples.data() + at, samples.data() + at + each);
    }
}

}  // namespace palpate::io
