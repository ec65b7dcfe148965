// The order of the bytes in a sample or a number.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <span>

namespace palpate::io {

/// Turns the bytes of each sample round; `each`: bytes of one sample.
inline void swap_bytes(std::span<std::byte> samples, std::size_t each) {
    for (std::size_t at = 0; each > 1 && at + each <= samples.size(); at += each) {
        std::reverse(samples.data() + at, samples.data() + at + each);
    }
}

/// The number that some bytes begin with, in the machine's order or, `swapped`, in the other one.
template <class T>
T number_in(std::span<const std::byte> bytes, bool swapped) {
    std::array<std::byte, sizeof(T)> raw;
    std::ranges::copy(bytes.first(sizeof(T)), raw.begin());
    if (swapped) std::ranges::reverse(raw);
    return std::bit_cast<T>(raw);
}
template <class T>
T little_endian(std::span<const std::byte> bytes) {
    return number_in<T>(bytes, std::endian::native == std::endian::big);
}
template <class T>
T big_endian(std::span<const std::byte> bytes) {
    return number_in<T>(bytes, std::endian::native == std::endian::little);
}

}  // namespace palpate::io
