// Puts measurements into words, and chooses units and decimals.
#include "apps/viewer/model/measurement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string_view>

namespace palpate::viewer {
namespace {

// Of voxels; below, lengths are in micrometres, from the second on in metres.
constexpr double fine_mm = 0.01, coarse_mm = 100;

std::string number_with(double value, const std::string& unit) {
    char text[64];
    std::snprintf(text, sizeof text, value < 100 ? "%.3g" : "%.1f", value);
    return text + (" " + unit);
}

}  // namespace

std::string length_text(double mm, LengthUnit unit, const std::string& voxel) {
    switch (unit) {
        case LengthUnit::micrometres:
            return number_with(1e3 * mm, "µm");
        case LengthUnit::automatic:
        case LengthUnit::millimetres:
            break;
        case LengthUnit::metres:
            return number_with(1e-3 * mm, "m");
        case LengthUnit::centimetres:
            return number_with(0.1 * mm, "cm");
        case LengthUnit::inches:
            return number_with(mm / 25.4, "in");
        case LengthUnit::voxels:
            return number_with(mm, voxel);
    }
    return number_with(mm, "mm");
}

LengthUnit unit_in(const Geometry& geometry, LengthUnit preferred) {
    const double every = geometry.spacing[0];  // of the finest level's, 1 unless it is coarser
    const bool counted = !geometry.measured && geometry.spacing == Vec3::Constant(every) &&
                         every == std::round(every);
    if (counted) return LengthUnit::voxels;
    if (preferred != LengthUnit::automatic) return preferred;
    const double voxel = geometry.spacing.minCoeff();
    return !geometry.measured || (voxel >= fine_mm && voxel < coarse_mm) ? LengthUnit::millimetres
           : voxel < fine_mm                                             ? LengthUnit::micrometres
                                                                         : LengthUnit::metres;
}

const char* unit_word(const Geometry& geometry) {
    return unit_in(geometry) == LengthUnit::voxels ? "voxel" : "mm";
}

std::size_t points_of(Measure kind) {
    return kind == Measure::length ? 2 : 3;
}

std::string text_of(const Measurement& m, LengthUnit unit, const std::string& voxel) {
    if (m.points.size() < points_of(m.kind)) return {};
    if (m.kind == Measure::length) {
        return length_text((m.points[1] - m.points[0]).norm(), unit, voxel);
    }
    const Vec3 a = m.points[0] - m.points[1], b = m.points[2] - m.points[1];
    if (a.norm() == 0 || b.norm() == 0) return {};
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
    char text[32];
    std::snprintf(text, sizeof text, "%.1f°", angle);
    return text;
}

Ruler ruler_of(const Geometry& geometry) {
    constexpr double seen_part = 0.2;
    constexpr int most_decimals = 6;
    const double voxel = geometry.spacing.minCoeff();
    Ruler ruler;
    ruler.unit = unit_word(geometry);
    const LengthUnit unit = unit_in(geometry, LengthUnit::automatic);
    if (unit == LengthUnit::micrometres) ruler = {"µm", 1e3, 1};
    if (unit == LengthUnit::metres) ruler = {"m", 1e-3, 1};
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
