// What a slice pane holds of a volume; for its own sources alone.
#pragma once

#include <QElapsedTimer>
#include <QImage>

#include <optional>

#include "apps/viewer/slices/slice_pane.hpp"

namespace palpate::viewer {

/// The data of a volume that the pane holds.
struct SlicePane::Content {
    SlicePlane plane;
    SliceSamples samples;
    std::optional<GreyWindow> usual;  ///< the first that was set
    QImage picture;                   ///< grey levels and contour; null: to be made
    std::optional<Field> newer;       ///< not yet in samples: another version of the same grid
    QElapsedTimer made;               ///< since then
    qint64 took_ms = 0;

    Content(const Field& field, const SlicePlane& across) : plane(across), samples(field, across) {}
};

}  // namespace palpate::viewer
