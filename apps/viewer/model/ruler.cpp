// Chooses units and decimals.
#include "apps/viewer/model/ruler.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "apps/viewer/model/measurement.hpp"

namespace palpate::viewer {

Ruler ruler_of(const Geometry& geometry) {
    constexpr double fine_mm = 0.01, coarse_mm = 100, seen_part = 0.2;
    constexpr int most_decimals = 6;
    const double voxel = geometry.spacing.minCoeff();
    Ruler ruler;
    ruler.unit = unit_word(geometry);
    if (geometry.measured && voxel < fine_mm) ruler = {"µm", 1e3, 1};
    if (geometry.measured && voxel >= coarse_mm) ruler = {"m", 1e-3, 1};
    const double digits = std::ceil(-std::log10(seen_part * voxel * ruler.per_mm) - 1e-9);
    ruler.decimals = std::clamp(static_cast<int>(digits), 1, most_decimals);
    return ruler;
}

std::string Ruler::number(double mm, int least_decimals) const {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", std::max(decimals, least_decimals), per_mm * mm);
    const bool is_zero = std::string_view(text).find_first_not_of("-0.") == std::string::npos;
    return is_zero && text[0] == '-' ? text + 1 : text;
}

}  // namespace palpate::viewer
