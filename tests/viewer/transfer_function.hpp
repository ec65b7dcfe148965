// Whether points make a transfer function.
#pragma once

#include <algorithm>
#include <cmath>

#include "apps/viewer/model/look.hpp"

namespace palpate::viewer {

/// Two or more points, their levels finite and strictly rising, opacities and colours 0 to 1.
inline bool is_valid(const TransferFunction& transfer) {
    const auto& points = transfer.points;
    const auto part = [](double x) { return x >= 0 && x <= 1; };
    const auto valid = [&](const ControlPoint& p) {
        return std::isfinite(p.level) && part(p.opacity) && part(p.colour.red) &&
               part(p.colour.green) && part(p.colour.blue);
    };
    const auto not_rising = [](const auto& a, const auto& b) { return !(a.level < b.level); };
    return points.size() >= 2 && std::ranges::all_of(points, valid) &&
           std::ranges::adjacent_find(points, not_rising) == points.end();
}

}  // namespace palpate::viewer
