// The one function of zlib that recordings use: the CRC-32. Emscripten would download zlib.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

using Bytef = unsigned char;

inline unsigned long crc32_z(unsigned long before, const Bytef* bytes, std::size_t count) {
    static constexpr auto table = [] {
        std::array<std::uint32_t, 256> made{};
        for (std::uint32_t i = 0; i < 256; ++i) {
            std::uint32_t rest = i;
            for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ (rest & 1 ? 0xedb88320u : 0);
            made[i] = rest;
        }
        return made;
    }();
    auto crc = ~static_cast<std::uint32_t>(before);
    for (std::size_t i = 0; bytes && i < count; ++i) crc = table[(crc ^ bytes[i]) & 255] ^ (crc >> 8);
    return bytes ? static_cast<std::uint32_t>(~crc) : 0;
}
