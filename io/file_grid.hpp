// The lengths that files and stores may give, in one place: whatever one reader takes, each writer
// writes and each other reader takes too. Needs the core only.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "io/words.hpp"
#include "palpate/volume.hpp"

namespace palpate::io {

/// What spacings and positions may be [mm], far beyond what is scanned. Libraries compute with
/// them: one of theirs never returns from a matrix of 3e38.
constexpr double least_length = 1e-9, greatest_length = 1e9;

/// The limits count for what is stored in 32 bits too.
inline bool is_file_spacing(double spacing) {
    constexpr double rounding = 1e-6;
    return spacing >= (1 - rounding) * least_length && spacing <= (1 + rounding) * greatest_length;
}

inline bool is_file_position(double coordinate) {
    return std::abs(coordinate) <= greatest_length;
}

/// Why a grid cannot be that of a file, or nothing: check() and the limits.
inline std::string why_no_file_grid(const Geometry& grid) {
    try {
        check(grid);
    } catch (const std::invalid_argument& e) {
        return e.what();
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (!is_file_spacing(grid.spacing[axis])) {
            return "its spacing of " + text_of(grid.spacing[axis]) +
                   " mm is outside 1e-9 to 1e9 mm";
        }
        if (!is_file_position(grid.origin[axis])) {
            return "its position of " + text_of(grid.origin[axis]) +
                   " mm is more than 1e9 mm from the origin";
        }
    }
    return {};
}

/// The same for those who write.
inline std::string why_not_stored(const Geometry& grid) {
    const std::string why = why_no_file_grid(grid);
    return why.empty() ? why
                       : "the volume cannot be stored: " + why + ", so no reader would take it";
}

}  // namespace palpate::io
