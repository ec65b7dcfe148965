// Chooses unit and decimals for the positions and lengths of a volume.
#pragma once

#include <string>

#include "palpate/volume.hpp"

namespace palpate::viewer {

/// With enough decimals for a fifth of the smallest spacing, and in micrometres if that is below
/// 10 µm, or in metres from 100 mm on.
struct Ruler {
    const char* unit = "mm";
    double per_mm = 1;
    int decimals = 1;

    /// The number without its unit, with at least so many decimals.
    std::string number(double mm, int least_decimals = 1) const;
};
Ruler ruler_of(const Geometry& geometry);

}  // namespace palpate::viewer
