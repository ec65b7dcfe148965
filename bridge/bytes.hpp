// Numbers as the network has them, the highest byte first. Header only, for wire.cpp and image.cpp.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace palpate::bridge {

template <std::size_t bytes>
using Word = std::conditional_t<
    bytes == 1, std::uint8_t,
    std::conditional_t<bytes == 2, std::uint16_t,
                       std::conditional_t<bytes == 4, std::uint32_t, std::uint64_t>>>;

template <class T>
void put(std::string& to, T value) {
    const auto word = std::bit_cast<Word<sizeof(T)>>(value);
    for (std::size_t i = sizeof(T); i-- > 0;) to += static_cast<char>(word >> (8 * i) & 0xFF);
}

/// A text in a field of this size, cut or filled up with zeros.
inline void put_text(std::string& to, std::string_view text, std::size_t size) {
    to.append(text.substr(0, size));
    to.append(size - std::min(size, text.size()), '\0');
}

/// The caller has checked that the number lies inside.
template <class T>
T number_at(std::string_view bytes, std::size_t at) {
    Word<sizeof(T)> word = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        word = static_cast<Word<sizeof(T)>>(std::uint64_t{word} << 8 |
                                            static_cast<unsigned char>(bytes[at + i]));
    }
    return std::bit_cast<T>(word);
}

}  // namespace palpate::bridge
