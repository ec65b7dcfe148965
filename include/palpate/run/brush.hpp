// The editing brush that follows a proxy.
#pragma once

#include <optional>

#include "palpate/edit.hpp"
#include "palpate/names.hpp"

namespace palpate::run {

/// A ball around the SCP, or the tool's own shape. It works along the proxy's path while the proxy
/// touches the surface. In free space it has no effect, because it would remove the surface before
/// the hand can touch it.
struct HandBrush {
    BrushKind kind = BrushKind::carve;
    double radius = 3;    ///< [mm, physical]; with `as_tool`: how far beyond the tool's surface
    double hardness = 1;  ///< Brush::hardness
    double rate =
        10;  ///< [1/s] after one second 1 - exp(-rate) of the change is done; inf: at once
    /// [data units] The value that it leaves. Nothing: that of brush_for().
    std::optional<double> value = {};

    /// It has the tool's own shape at the proxy's pose. That of a point is a ball.
    bool as_tool = false;

    bool operator==(const HandBrush&) const = default;
};
/// A brush that carves a few voxels.
HandBrush usual_brush(const Geometry& geometry);
/// A brush that carves with the tool's own shape, a voxel beyond its surface. With less, material
/// at sharp corners remains, because the grid cannot represent such a narrow cavity.
HandBrush tool_brush(const Geometry& geometry);
/// Throws std::invalid_argument, with the reason, for a brush that cannot work.
void check(const HandBrush& brush);

/// The Brush for a proxy in contact during `dt` [s] at this level, with the strength for that time.
/// Nothing if it would have no effect.
std::optional<Brush> brush_at(const HandBrush& brush, const Field& field, double isovalue,
                              double dt);

}  // namespace palpate::run

namespace palpate {

template <>
inline constexpr auto settings_of<run::HandBrush> =
    std::tuple{setting(&run::HandBrush::kind, "kind", "", "'carve', 'add', 'smooth' or 'paint'"),
               setting(&run::HandBrush::radius, "radius", "mm, physical",
                       "Radius of the ball. With the shape of a tool: how far beyond its surface")
                   .titled("radius of the brush")
                   .within(ranges::positive),
               setting(&run::HandBrush::hardness, "hardness", "",
                       "1: an edge two voxels wide; 0: as wide as the brush")
                   .titled("hardness of the brush")
                   .within(ranges::part),
               setting(&run::HandBrush::rate, "rate", "1/s",
                       "After a second 1 - exp(-rate) of the change is done")
                   .titled("rate of the brush")
                   .within({0, ranges::infinity, true, "above 0 (inf: at once)"}),
               setting(&run::HandBrush::value, "value", "data units", "Value that it leaves")
                   .titled("value of the brush")
                   .within(ranges::finite)
                   .if_open("the usual one"),
               setting(&run::HandBrush::as_tool, "as_tool", "",
                       "It has the shape of the tool. That of a point is a ball")};

}  // namespace palpate
