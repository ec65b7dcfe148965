// What a painter is asked for and what it gives: values and shared data that nobody changes.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/look.hpp"
#include "apps/viewer/scene/surface_work.hpp"
#include "palpate/field.hpp"
#include "pictures/scene.hpp"

namespace palpate::viewer {

/// All that stands still while the hand moves, from one camera.
struct Shot {
    std::uint64_t number = 0;    ///< rising with every change
    std::optional<Field> field;  ///< nothing: an empty scene
    DrawnSurface surface;
    Look look;
    Vec3 crosshair = Vec3::Zero();  ///< [mm, physical]
    Colour background;
    Colour ink;  ///< of lines
    pictures::Camera camera;
    int width = 1, height = 1;  ///< [device pixels]
    double pixel_ratio = 1;     ///< device pixels a logical pixel
    bool moving = false;        ///< quick rather than fine
};

/// A picture with depths, row by row from the bottom; depths from 0, near, to 1.
struct Layer {
    std::vector<unsigned char> rgba;
    std::vector<float> depth;
};

/// What a painter has drawn.
struct Backdrop {
    std::uint64_t number = 0;
    int width = 0, height = 0;  ///< as asked for, or half of it while things move slowly
    pictures::Camera camera;
    double reach = 1;  ///< [mm] see reach_of(), of the volume that is shown
    Layer solid;
    /// A surface that is seen through: alpha is how dense it is. Empty where there is none.
    Layer glass;
    bool moving = false;
    double seconds = 0;     ///< that it took
    bool hardware = false;  ///< drawn by graphics hardware, not by the processor
};

}  // namespace palpate::viewer
