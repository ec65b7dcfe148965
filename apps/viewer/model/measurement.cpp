// Puts measurements into words.
#include "apps/viewer/model/measurement.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace palpate::viewer {
namespace {

std::string number_with(double value, const std::string& unit) {
    char text[64];
    std::snprintf(text, sizeof text, value < 100 ? "%.3g" : "%.1f", value);
    return text + (" " + unit);
}

}  // namespace

std::string length_text(double mm, LengthUnit unit, const std::string& voxel) {
    switch (unit) {
        case LengthUnit::automatic:
            if (mm >= 1e4) return number_with(1e-3 * mm, "m");
            return length_text(mm, mm < 0.1 ? LengthUnit::micrometres : LengthUnit::millimetres);
        case LengthUnit::micrometres:
            return number_with(1e3 * mm, "µm");
        case LengthUnit::millimetres:
            break;
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
    return counted ? LengthUnit::voxels : preferred;
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

}  // namespace palpate::viewer
