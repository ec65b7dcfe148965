// Strokes of the brush that follows a proxy.
#include "palpate/run/brush.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::run {

HandBrush usual_brush(const Geometry& geometry) {
    HandBrush brush;
    brush.radius = 3 * geometry.spacing.maxCoeff();
    return brush;
}

void check(const HandBrush& brush) {
    if (!(brush.radius > 0) || !std::isfinite(brush.radius)) {
        throw std::invalid_argument("the brush's radius [mm] must be finite and above 0");
    }
    if (!(brush.hardness >= 0 && brush.hardness <= 1)) {
        throw std::invalid_argument("the brush's hardness must be 0 to 1");
    }
    if (!(brush.rate > 0)) {
        throw std::invalid_argument("the brush's rate [1/s] must be above 0 (inf: at once)");
    }
    if (brush.value && !std::isfinite(*brush.value)) {
        throw std::invalid_argument("the brush's value must be finite");
    }
}

std::optional<edit::Stroke> stroke_of(const HandBrush& hand, const Field& field, double isovalue,
                                      const Vec3& from, const Vec3& to, double dt) {
    if (!std::isfinite(isovalue) || !(dt > 0)) return std::nullopt;
    edit::Stroke stroke{brush_for(hand.kind, field, isovalue, hand.radius), from, to};
    stroke.brush.hardness = hand.hardness;
    stroke.brush.strength = -std::expm1(-hand.rate * dt);
    if (hand.value) stroke.brush.value = *hand.value;
    if (!(stroke.brush.strength > 0)) return std::nullopt;
    return stroke;
}

}  // namespace palpate::run
