// Stage 8, cubic: the piece of the smooth field that a proxy keeps from one update to the next, and
// the samples that it was made from, by which the next update knows whether it still holds.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "palpate/cubic.hpp"

namespace palpate::cubic {

/// A sample and its neighbours, to the bit.
class KeptSamples {
  public:
    template <class T>
    void keep(const T* centre, std::ptrdiff_t row, std::ptrdiff_t slice) {
        type_ = type_of<T>;
        std::byte* to = bytes_.data();
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
    bool are(const T* centre, std::ptrdiff_t row, std::ptrdiff_t slice) const {
        if (type_ != type_of<T>) return false;
        const std::byte* kept = bytes_.data();
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

    int type_ = 0;  // none
    std::array<std::byte, 27 * sizeof(double)> bytes_{};
};

/// The piece that an update made last, for the next one, which mostly begins in its tetrahedron. It
/// is used only where all that it was made from is the same, so results do not depend on it.
struct KeptPiece {
    double isovalue = 0;  ///< less the field's offset [data units]
    double sign = 0;
    Tetrahedron tetrahedron;
    Piece piece;  ///< of the excess, sign * (f - isovalue)
    /// Nothing in the tetrahedron's cube lies above: the greatest excess of the samples round it,
    /// once it was looked for, times `scale`.
    double most = std::numeric_limits<double>::infinity();
};

}  // namespace palpate::cubic
