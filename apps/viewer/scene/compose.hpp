// Puts translucent layers over each other.
#pragma once

#include <vector>

#include "pictures/vtk/layer.hpp"

namespace palpate::viewer {

using pictures::Layer;

/// One layer that looks as all of them do, the nearest first at each pixel, without what lies
/// behind `solid`; its depth is the nearest one's. Colours are not multiplied by alpha. Empty
/// without layers. All must have as many pixels.
Layer composed(std::vector<Layer> layers, const Layer& solid);

}  // namespace palpate::viewer
