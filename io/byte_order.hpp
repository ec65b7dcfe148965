// The order of the bytes in a sample.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace palpate::io {

/// Turns the bytes of each sample round; `each`: bytes of one sample.
inline void swap_bytes(std::span<std::byte> samples, std::size_t each) {
    const auto turn = [&]<std::size_t n>() {
        for (std::size_t at = 0; at + n <= samples.size(); at += n) {
            std::reverse(samples.data() + at, samples.data() + at + n);
        }
    };
    if (each == 2) turn.template operator()<2>();
    if (each == 4) turn.template operator()<4>();
}

}  // namespace palpate::io
