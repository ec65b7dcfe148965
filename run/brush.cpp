// A step of the brush that follows a proxy.
#include "palpate/run/brush.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::run {

HandBrush usual_brush(const Geometry& geometry) {
    HandBrush brush;
    brush.radius = 3 * geometry.spacing.maxCoeff();
    return brush;
}

HandBrush tool_brush(const Geometry& geometry) {
    HandBrush brush;
    brush.radius = geometry.spacing.maxCoeff();
    brush.as_tool = true;
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

std::optional<Brush> brush_at(const HandBrush& hand, const Field& field, double isovalue,
                              double dt) {
    if (!std::isfinite(isovalue) || !(dt > 0)) return std::nullopt;
    Brush brush = brush_for(hand.kind, field, isovalue, hand.radius);
    brush.hardness = hand.hardness;
    brush.strength = -std::expm1(-hand.rate * dt);
    if (hand.value) brush.value = *hand.value;
    if (!(brush.strength > 0)) return std::nullopt;
    return brush;
}

}  // namespace palpate::run
