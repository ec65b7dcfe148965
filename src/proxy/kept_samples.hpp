// The samples that a proxy's kept piece was made from: whether they are still the same, to the bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "palpate/proxy.hpp"

namespace palpate {

/// What a proxy keeps, for those who may look into it.
struct Kept {
    static const cubic::Piece& piece(const KeptPiece& kept) { return kept.piece; }

    template <class T>
    static void keep(KeptSamples& samples, const T* centre, std::ptrdiff_t row,
                     std::ptrdiff_t slice) {
        samples.type = type_of<T>;
        std::byte* to = samples.bytes.data();
        for_each_row(centre, row, slice, [&](const T* from) {
            std::memcpy(to, from, 3 * sizeof(T));
            to += 3 * sizeof(T);
        });
    }
    template <class T>
    static bool are(const KeptSamples& samples, const T* centre, std::ptrdiff_t row,
                    std::ptrdiff_t slice) {
        if (samples.type != type_of<T>) return false;
        const std::byte* kept = samples.bytes.data();
        std::uint64_t apart = 0;  // a branch for each row would cost as much as all the rest
        for_each_row(centre, row, slice, [&](const T* now) {
            apart |= difference<3 * sizeof(T)>(reinterpret_cast<const std::byte*>(now), kept);
            kept += 3 * sizeof(T);
        });
        return apart == 0;
    }

  private:
    template <class T>
    static constexpr int type_of = static_cast<int>(sizeof(T)) * (std::is_signed_v<T> ? -1 : 1);
    /// The bits in which so many bytes differ, word by word: a call costs as much as all the rest.
    template <std::size_t bytes>
    static std::uint64_t difference(const std::byte* a, const std::byte* b) {
        using UpTo4 = std::conditional_t<(bytes < 2), std::uint8_t, std::uint16_t>;
        using UpTo8 = std::conditional_t<(bytes < 4), UpTo4, std::uint32_t>;
        using Word = std::conditional_t<(bytes < 8), UpTo8, std::uint64_t>;
        Word x, y;
        std::memcpy(&x, a, sizeof x);
        std::memcpy(&y, b, sizeof y);
        constexpr std::size_t left = bytes - sizeof x;
        if constexpr (left > 0) return (x ^ y) | difference<left>(a + sizeof x, b + sizeof x);
        return x ^ y;
    }
};

}  // namespace palpate
