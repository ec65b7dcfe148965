// How a scene is shown: plain values that panel and scene share and a session file keeps.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "palpate/volume.hpp"
#include "pictures/scene.hpp"

namespace palpate::viewer {

using pictures::Colour;

inline Colour mixed(const Colour& a, const Colour& b, double t) {
    return {std::lerp(a.red, b.red, t), std::lerp(a.green, b.green, t),
            std::lerp(a.blue, b.blue, t)};
}

/// Where a transfer function changes: between two points colour and opacity run straight, beyond
/// the outer ones they stay.
struct ControlPoint {
    double level = 0;    ///< [data units]
    Colour colour;       ///< sRGB
    double opacity = 0;  ///< 0 to 1, of a layer as thick as the smallest spacing

    bool operator==(const ControlPoint&) const = default;
};

/// Colour and opacity by density, for volume rendering.
struct TransferFunction {
    std::string preset;                ///< which one it was made from; empty once it was edited
    std::vector<ControlPoint> points;  ///< at least two, levels strictly rising

    bool operator==(const TransferFunction&) const = default;
};

/// Of the brush round the proxy: orange (Okabe and Ito).
inline constexpr pictures::Colour brush_colour{0.902, 0.624, 0};

/// A surface that is seen beside the one that is felt.
struct SeenSurface {
    double level = 0;  ///< [data units]
    Colour colour;     ///< sRGB
    double opacity = 1;
    bool shown = true;

    bool operator==(const SeenSurface&) const = default;
};
/// Those beside the felt one are so many at most: each keeps a mesh in memory.
inline constexpr std::size_t most_surfaces = 8;

/// What is cut away of surfaces and volume, so that one sees into them.
enum class Cut : std::uint8_t { nothing, plane, box };

/// Cut away is the side to which the normal points.
struct CutPlane {
    Vec3 point = Vec3::Zero();  ///< [mm, physical]
    Vec3 normal = -Vec3::UnitY();

    bool operator==(const CutPlane&) const = default;
};
/// Cut away is what lies outside. Parts of the grid along each of its axes, 0 to 1.
struct CutBox {
    Vec3 low = Vec3::Zero(), high = Vec3::Ones();

    bool operator==(const CutBox&) const = default;
};

struct OverlayLook {
    bool shown = true;
    double opacity = 0.5;         ///< in slices
    std::string colours = "hot";  ///< the colour map of an image
    bool surface = true;          ///< in the scene
    double surface_opacity = 1;
    std::optional<double> level;  ///< [data units] of an image's surface; nothing: suggested
    std::vector<int> hidden;      ///< labels

    bool operator==(const OverlayLook&) const = default;
};

/// What is in the scene and how it looks.
struct Look {
    bool surface = true;  ///< the isosurface that is felt
    Colour surface_colour = pictures::bone;
    double surface_opacity = 1;
    std::vector<SeenSurface> surfaces;  ///< beside the felt one
    Cut cut = Cut::nothing;
    CutPlane cut_plane;
    CutBox cut_box;
    std::string colours = "grey";  ///< the colour map of the slices
    OverlayLook overlay;
    bool volume = false;  ///< volume rendering
    TransferFunction transfer;
    bool shading = true;                      ///< of the volume
    bool maximum = false;                     ///< the volume as its maximum intensity projection
    bool slices = false;                      ///< three planes through the crosshair
    bool contact = true;                      ///< HIP, SCP, spring and force
    bool tetrahedra = false, planes = false;  ///< round the SCP: the paper's figures
    bool box = true, orientation = true, scale_bar = true;

    bool operator==(const Look&) const = default;
};

}  // namespace palpate::viewer
