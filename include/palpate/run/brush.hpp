// The editing brush that follows a proxy.
#pragma once

#include <optional>

#include "palpate/edit.hpp"

namespace palpate::run {

/// Works along the proxy's path while the proxy touches the surface. In the air it does nothing: it
/// would remove the surface before it is felt.
struct HandBrush {
    BrushKind kind = BrushKind::carve;
    double radius = 3;    ///< [mm, physical]
    double hardness = 1;  ///< Brush::hardness
    double rate =
        10;  ///< [1/s] after one second 1 - exp(-rate) of the change is done; inf: at once
    /// [data units] The value that it leaves; nothing: what brush_for() takes.
    std::optional<double> value = {};

    bool operator==(const HandBrush&) const = default;
};
/// A brush that carves a few voxels.
HandBrush usual_brush(const Geometry& geometry);
/// Throws std::invalid_argument, saying what is wrong, for a brush that cannot work.
void check(const HandBrush& brush);

/// The stroke of a brush while a proxy in contact moves between two points [mm, physical] in `dt`
/// [s]; nothing where there is nothing to do. `isovalue` is the level felt.
std::optional<edit::Stroke> stroke_of(const HandBrush& brush, const Field& field, double isovalue,
                                      const Vec3& from, const Vec3& to, double dt);

}  // namespace palpate::run
