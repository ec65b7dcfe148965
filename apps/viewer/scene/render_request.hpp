// What a render thread is asked to draw, and the image that it returns: values and immutable shared
// data.
#pragma once

#include <optional>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "apps/viewer/scene/surface_extractor.hpp"
#include "palpate/field.hpp"
#include "pictures/scene.hpp"
#include "pictures/vtk/layer.hpp"

namespace palpate::viewer {

/// A surface in the scene.
struct DrawnSurface {
    ExtractedSurface surface;
    Colour colour;
    double opacity = 1;          ///< 0: not drawn
    Vec3 offset = Vec3::Zero();  ///< [mm] of its origin from the middle of the grid

    bool operator==(const DrawnSurface&) const = default;
};

/// The static part of the scene, which does not follow the hand, seen by one camera.
struct RenderRequest {
    std::uint64_t number = 0;            ///< rising with every change
    std::optional<Field> field;          ///< nothing: an empty scene
    std::vector<DrawnSurface> surfaces;  ///< the felt one first
    Look look;
    Vec3 crosshair = Vec3::Zero();  ///< [mm, physical]
    Colour background;
    Colour ink;  ///< of lines
    pictures::Camera camera;
    int width = 1, height = 1;  ///< [device pixels]
    double pixel_ratio = 1;     ///< device pixels a logical pixel
    bool moving = false;        ///< quick rather than fine
};

using pictures::Layer;

/// What a render thread has drawn.
struct RenderedImage {
    std::uint64_t number = 0;
    int width = 0, height = 0;  ///< as asked for, or half of it while things move slowly
    pictures::Camera camera;
    double reach = 1;  ///< [mm] see reach_of(), of the volume that is shown
    Layer solid;
    /// What is translucent, with its opacity as alpha. Empty without any.
    Layer glass;
    bool moving = false;
    double seconds = 0;     ///< that it took
    bool hardware = false;  ///< drawn by graphics hardware, not by the processor
};

}  // namespace palpate::viewer
