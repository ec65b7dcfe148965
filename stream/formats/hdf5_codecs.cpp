// Filters of HDF5 that do not compress. See the header.
#include "stream/formats/undo_codecs.hpp"

#include <algorithm>
#include <cstdint>

namespace palpate::stream {

std::uint32_t fletcher32_of(std::span<const std::byte> bytes) {
    constexpr std::size_t words_before_overflow = 360;
    std::uint32_t sum = 0, sum_of_sums = 0;
    const auto reduce = [](std::uint32_t& number) { number = (number & 0xFFFF) + (number >> 16); };
    const auto add = [&](std::byte high, std::byte low) {
        sum += std::to_integer<std::uint32_t>(high) << 8 | std::to_integer<std::uint32_t>(low);
        sum_of_sums += sum;
    };
    const std::size_t words = bytes.size() / 2;
    for (std::size_t at = 0; at < words;) {
        const std::size_t end = std::min(words, at + words_before_overflow);
        for (; at < end; ++at) add(bytes[2 * at], bytes[2 * at + 1]);
        reduce(sum);
        reduce(sum_of_sums);
    }
    if (bytes.size() % 2 != 0) {
        add(bytes.back(), std::byte{0});
        reduce(sum);
        reduce(sum_of_sums);
    }
    reduce(sum);
    reduce(sum_of_sums);
    return sum_of_sums << 16 | sum;
}

std::vector<std::byte> unshuffled(std::span<const std::byte> bytes, std::size_t each) {
    const std::size_t samples = bytes.size() / each;
    std::vector<std::byte> out(bytes.begin(), bytes.end());
    for (std::size_t b = 0; b < each; ++b) {
        for (std::size_t i = 0; i < samples; ++i) out[i * each + b] = bytes[b * samples + i];
    }
    return out;
}

}  // namespace palpate::stream
