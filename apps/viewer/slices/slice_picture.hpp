// The image of a slice: grey levels and the isosurface's contour.
#pragma once

#include <QColor>
#include <QImage>

#include "apps/viewer/slices/contour.hpp"
#include "apps/viewer/slices/slice_map.hpp"

namespace palpate::viewer {

/// The colour of the contour: a light vermilion, like the proxy's.
QColor contour_colour();

/// The slice as it is seen through `map` in a widget of `size`, `scale` device pixels a pixel;
/// black where there are no data. Levels up to window.low are black, from window.high white.
/// Nothing is drawn beyond what is seen.
QImage slice_picture(const SliceSamples& samples, const SliceMap& map, const GreyWindow& window,
                     double isovalue, const QSize& size, double scale);

}  // namespace palpate::viewer
