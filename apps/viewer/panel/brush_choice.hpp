// The brush that the user has chosen in the panel, as a plain value.
#pragma once

#include <optional>

#include "palpate/edit.hpp"

namespace palpate::viewer {

struct BrushChoice {
    BrushKind kind = BrushKind::carve;
    double radius = 3;    ///< [mm]
    double hardness = 1;  ///< 0 to 1, Brush::hardness
    /// [1/s], Brush::strength says what it means for a touch; infinity: all of it at once.
    double rate = 10;
    /// The value that a whole touch leaves [data units], Brush::value; none: the one that
    /// brush_for() chooses for the level felt. Smoothing has none.
    std::optional<double> value = std::nullopt;
    bool on = false;  ///< the probe edits where it is

    bool operator==(const BrushChoice&) const = default;
};

}  // namespace palpate::viewer
