// The part of a volume that a slice pane keeps. Private to the pane's sources.
#pragma once

#include <QElapsedTimer>
#include <QImage>

#include <optional>

#include "apps/viewer/slices/slice_pane.hpp"

namespace palpate::viewer {

/// The data of a volume that the pane holds.
struct SlicePane::Content {
    SlicePlane plane;  ///< that slices are counted in
    SliceSamples samples;
    double layer = 0;                           ///< of the grid, that the picture shows
    std::shared_ptr<const DetailField> finer;   ///< of a part; null: none
    std::optional<SliceSamples> finer_samples;  ///< its own
    QImage picture;                             ///< grey levels and contour; null: to be made
    SliceStyle style;                           ///< of the picture
    std::optional<Field> newer;  ///< not yet in samples: another version of the same grid
    QElapsedTimer made;          ///< since then
    qint64 took_ms = 0;

    Content(const Field& field, const SlicePlane& counted)
        : plane(counted), samples(field, counted) {}
};

}  // namespace palpate::viewer
