// A step of the brush that follows a proxy.
#include "palpate/run/brush.hpp"

#include <cmath>

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
    check_ranges(brush);
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
