// Replaces samples that are not finite, which a field cannot have, by the least finite one. Shared
// by the raw reader and the helper program.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

namespace palpate::io {

/// Replaces NaN and infinities by the least finite sample; returns how many there were (all of
/// them, unchanged, if none is finite).
inline std::uint64_t replace_non_finite(std::span<float> samples) {
    float least = std::numeric_limits<float>::infinity();
    std::uint64_t count = 0;
    for (const float s : samples) {
        if (!std::isfinite(s)) {
            ++count;
        } else if (s < least) {
            least = s;
        }
    }
    if (count == 0 || count == samples.size()) return count;
    for (float& s : samples) {
        if (!std::isfinite(s)) s = least;
    }
    return count;
}

/// The note about such replacements.
inline std::string non_finite_note(std::uint64_t count) {
    return std::to_string(count) + (count == 1 ? " sample was" : " samples were") +
           " not finite (NaN, infinity or beyond float32) and became the least finite value";
}

}  // namespace palpate::io
