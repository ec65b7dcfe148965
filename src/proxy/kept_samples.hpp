// The samples that a proxy's kept piece was made from: whether they are still the same, to the bit,
// in a few instructions.
#pragma once

#include <array>
#include <bit>
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
        if constexpr (sizeof(T) <= 2) {
            for_each_word(centre, row, slice, [&](Word<T> word, bool) {
                std::memcpy(to, &word, sizeof word);
                to += sizeof word;
            });
            return;
        }
        for (const std::ptrdiff_t z : {-slice, std::ptrdiff_t{0}, slice}) {
            for (const std::ptrdiff_t y : {z - row, z, z + row}) {
                std::memcpy(to, centre + y - 1, 3 * sizeof(T));
                to += 3 * sizeof(T);
            }
        }
    }
    template <class T>
    static bool are(const KeptSamples& samples, const T* centre, std::ptrdiff_t row,
                    std::ptrdiff_t slice) {
        if (samples.type != type_of<T>) return false;
        const std::byte* kept = samples.bytes.data();
        if constexpr (sizeof(T) <= 2) {
            Word<T> apart = 0, apart_in_last = 0;
            for_each_word(centre, row, slice, [&](Word<T> word, bool is_last) {
                Word<T> other;
                std::memcpy(&other, kept, sizeof other);
                (is_last ? apart_in_last : apart) |= word ^ other;
                kept += sizeof other;
            });
            return ((apart & first_three<T>) | (apart_in_last & last_three<T>)) == 0;
        }
        bool same = true;
        for (const std::ptrdiff_t z : {-slice, std::ptrdiff_t{0}, slice}) {
            for (const std::ptrdiff_t y : {z - row, z, z + row}) {
                same &= same_three<T>(kept, centre + y - 1);
                kept += 3 * sizeof(T);
            }
        }
        return same;
    }

  private:
    template <class T>
    static constexpr int type_of = static_cast<int>(sizeof(T)) * (std::is_signed_v<T> ? -1 : 1);
    /// Four small samples: one comparison for a row of three.
    template <class T>
    using Word = std::conditional_t<sizeof(T) == 1, std::uint32_t, std::uint64_t>;
    template <class T>
    static constexpr Word<T> first_three = std::bit_cast<Word<T>>(std::array<T, 4>{T(-1), T(-1),
                                                                                   T(-1), T(0)});
    template <class T>
    static constexpr Word<T> last_three = std::bit_cast<Word<T>>(std::array<T, 4>{T(0), T(-1),
                                                                                  T(-1), T(-1)});
    /// The nine rows, each with the sample after it, but the last one with that before it: these
    /// lie among the 27, whatever the distance of the rows.
    template <class T, class Visit>
    static void for_each_word(const T* centre, std::ptrdiff_t row, std::ptrdiff_t slice,
                              Visit&& visit) {
        const auto word_at = [&](std::ptrdiff_t first) {
            Word<T> word;
            std::memcpy(&word, centre + first, sizeof word);
            return word;
        };
        visit(word_at(-slice - row - 1), false);
        visit(word_at(-slice - 1), false);
        visit(word_at(-slice + row - 1), false);
        visit(word_at(-row - 1), false);
        visit(word_at(-1), false);
        visit(word_at(row - 1), false);
        visit(word_at(slice - row - 1), false);
        visit(word_at(slice - 1), false);
        visit(word_at(slice + row - 2), true);
    }
    /// Without a call or a branch: each of them costs as much as all the rest.
    template <class Bits>
    static Bits difference_at(const std::byte* a, const std::byte* b) {
        Bits x, y;
        std::memcpy(&x, a, sizeof x);
        std::memcpy(&y, b, sizeof y);
        return x ^ y;
    }
    template <class T>
    static bool same_three(const std::byte* a, const T* from) {
        const auto* b = reinterpret_cast<const std::byte*>(from);
        if constexpr (sizeof(T) == 4) {
            return (difference_at<std::uint64_t>(a, b) |
                    difference_at<std::uint32_t>(a + 8, b + 8)) == 0;
        } else {
            return (difference_at<std::uint64_t>(a, b) |
                    difference_at<std::uint64_t>(a + 8, b + 8) |
                    difference_at<std::uint64_t>(a + 16, b + 16)) == 0;
        }
    }
};

}  // namespace palpate
