// Writes small NIfTI-1 files for the tests, with changes to their headers.
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "io/volume_support.hpp"

namespace palpate::io::test {

inline constexpr float infinite = std::numeric_limits<float>::infinity();
inline constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

/// A NIfTI-1 file of 2x3x4 int16 samples 0, 1, 2, ... with changes to its header.
inline std::string nifti(const std::function<void(std::string&)>& change, int steps = 1) {
    std::string header(352, '\0');
    const auto put = [&](std::size_t at, const std::string& bytes) {
        header.replace(at, bytes.size(), bytes);
    };
    put(0, little<std::int32_t>(348));
    const std::int16_t sizes[8] = {static_cast<std::int16_t>(steps > 1 ? 4 : 3),
                                   2,
                                   3,
                                   4,
                                   static_cast<std::int16_t>(steps),
                                   1,
                                   1,
                                   1};
    for (std::size_t i = 0; i < 8; ++i) put(40 + 2 * i, little(sizes[i]));
    put(70, little<std::int16_t>(4));
    put(72, little<std::int16_t>(16));
    for (std::size_t i = 0; i < 5; ++i) put(76 + 4 * i, little(1.0F));
    put(108, little(352.0F));
    put(123, "\x02");
    put(252, little<std::int16_t>(1));
    put(344, std::string("n+1\0", 4));
    change(header);
    for (std::int16_t i = 0; i < 24 * steps; ++i) header += little(i);
    return header;
}

inline void put_at(std::string& header, std::size_t at, const std::string& bytes) {
    header.replace(at, bytes.size(), bytes);
}

}  // namespace palpate::io::test
