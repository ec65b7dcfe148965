// Blends drawings over one another, pixel by pixel. Only the nearest part of a transparent surface
// is drawn, because its far side and inner parts would hide the rest.
#pragma once

#include <vector>

#include "pictures/vtk/layer.hpp"

namespace palpate::pictures {

/// Panes whose alpha is how dense they are, each where it is nearer than `picture`, the farther
/// ones first.
void lay_over(Layer& picture, const std::vector<Layer>& panes);

/// What of `hidden` lies behind the picture, mixed into it.
void shine_through(Layer& picture, const Layer& hidden, double opacity);

/// An overlay before everything, its colours already multiplied by its alpha.
void lay_over(Layer& picture, const Layer& overlay);

/// The mean of each block of scale x scale pixels, 3 bytes a pixel.
std::vector<unsigned char> reduced(const Layer& picture, int width, int height, int scale);

}  // namespace palpate::pictures
