// FNV-1a, for golden hashes of bytes that must never change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace palpate::scenes {

inline std::uint64_t hash_of(const void* data, std::size_t bytes) {
    const auto* at = static_cast<const unsigned char*>(data);
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (std::size_t i = 0; i < bytes; ++i) hash = (hash ^ at[i]) * 0x100000001b3u;
    return hash;
}

inline std::uint64_t hash_of(std::string_view text) {
    return hash_of(text.data(), text.size());
}

}  // namespace palpate::scenes
