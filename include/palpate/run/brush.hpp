// The editing brush that follows a proxy.
#pragma once

#include <optional>

#include "palpate/edit.hpp"

namespace palpate::run {

/// A ball about the SCP, or the tool's own shape. Works along the proxy's path while the proxy
/// touches the surface. In the air it does nothing: it would remove the surface before it is felt.
struct HandBrush {
    BrushKind kind = BrushKind::carve;
    double radius = 3;    ///< [mm, physical]; with `as_tool`: how far beyond the tool's skin
    double hardness = 1;  ///< Brush::hardness
    double rate =
        10;  ///< [1/s] after one second 1 - exp(-rate) of the change is done; inf: at once
    /// [data units] The value that it leaves; nothing: what brush_for() takes.
    std::optional<double> value = {};

    /// It has the tool's own shape at the proxy's pose. That of a point is a ball.
    bool as_tool = false;

    bool operator==(const HandBrush&) const = default;
};
/// A brush that carves a few voxels.
HandBrush usual_brush(const Geometry& geometry);
/// One that carves with the tool's own shape, a voxel beyond its skin: with less, sharp corners
/// stay where they are, because the grid cannot show the hollow that they would need.
HandBrush tool_brush(const Geometry& geometry);
/// Throws std::invalid_argument, saying what is wrong, for a brush that cannot work.
void check(const HandBrush& brush);

/// What a brush does while a proxy in contact works for `dt` [s] at this level: a Brush of that
/// strength; nothing where there is nothing to do.
std::optional<Brush> brush_at(const HandBrush& brush, const Field& field, double isovalue,
                              double dt);

}  // namespace palpate::run
