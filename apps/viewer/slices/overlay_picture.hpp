// An overlay in the picture of a slice.
#pragma once

#include <QImage>
#include <QString>

#include "apps/viewer/model/overlay.hpp"
#include "apps/viewer/slices/slice_map.hpp"

namespace palpate::viewer {

/// Over `picture`, by the look's opacity: labels in their colours, sample by sample; an image in
/// its colour map, interpolated, fading out towards its dark end. Each pixel is looked up in the
/// overlay's own grid, whatever that is. `position`: of the slice, in layers of `geometry`.
void draw_overlay(QImage& picture, const SlicePlane& plane, const Geometry& geometry,
                  const SliceMap& map, double position, const Overlay& overlay,
                  const OverlayLook& look);

/// What the overlay has at a point [mm, physical]: a label's name, or a number. Empty outside.
QString overlay_words(const Overlay& overlay, const Vec3& physical);

}  // namespace palpate::viewer
