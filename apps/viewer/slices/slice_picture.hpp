// The image of a slice: grey levels and the isosurface's contour.
#pragma once

#include <QColor>
#include <QImage>
#include <QRectF>

#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/colour_map.hpp"
#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/slices/contour.hpp"
#include "apps/viewer/slices/slice_map.hpp"

namespace palpate::viewer {

/// The colour of the contour: a light vermilion, like the proxy's.
QColor contour_colour();

/// How a slice is shown.
struct SliceStyle {
    GreyWindow
        window;  ///< levels up to window.low have the first colour, from window.high the last
    ColourTable colours = colour_table("grey");
    double isovalue = 0;                     ///< of the contour [data units]
    std::vector<SeenSurface> surfaces;       ///< contours of others, in their colours
    std::shared_ptr<const Overlay> overlay;  ///< null: none
    OverlayLook overlay_look;
};

/// A finer part of the slice, drawn in its place.
struct FinerSlice {
    const SliceSamples* samples;
    SliceMap map;
    QRectF drawn;  ///< [pixels] where
};

/// The slice as it is seen through `map` in a widget of `size`, `scale` device pixels a pixel;
/// black where there are no data. Nothing is drawn beyond what is seen.
QImage slice_picture(const SliceSamples& samples, const SlicePlane& plane, const SliceMap& map,
                     const SliceStyle& style, const QSize& size, double scale,
                     const std::optional<FinerSlice>& finer = {});

}  // namespace palpate::viewer
