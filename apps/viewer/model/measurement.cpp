// Puts measurements into words.
#include "apps/viewer/model/measurement.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace palpate::viewer {
namespace {

std::string number_with(double value, const char* unit) {
    char text[64];
    std::snprintf(text, sizeof text, value < 100 ? "%.3g%s" : "%.1f%s", value, unit);
    return text;
}

std::string length_words(double mm) {
    if (mm < 0.1) return number_with(1e3 * mm, " µm");
    return number_with(mm, " mm");
}

}  // namespace

std::size_t points_of(Measure kind) {
    return kind == Measure::length ? 2 : 3;
}

std::string text_of(const Measurement& m) {
    if (m.points.size() < points_of(m.kind)) return {};
    if (m.kind == Measure::length) return length_words((m.points[1] - m.points[0]).norm());
    const Vec3 a = m.points[0] - m.points[1], b = m.points[2] - m.points[1];
    if (a.norm() == 0 || b.norm() == 0) return {};
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
    char text[32];
    std::snprintf(text, sizeof text, "%.1f°", angle);
    return text;
}

}  // namespace palpate::viewer
