// The data that a slice pane holds of a volume. Private to the pane.
#pragma once

#include <QElapsedTimer>

#include <optional>

#include "apps/viewer/slices/slice_pane.hpp"
#include "apps/viewer/slices/slice_picture.hpp"

namespace palpate::viewer {

struct SlicePane::Content {
    SlicePlane plane;
    SliceSamples samples;
    GreyWindow usual;
    bool usual_given = false;    ///< from outside
    QImage picture;              ///< grey levels and contour; null: to be made
    std::optional<Field> newer;  ///< not yet in samples: another version of the same grid
    QElapsedTimer made;          ///< since then
    qint64 took_ms = 0;

    Content(const Field& field, const SlicePlane& across, const GreyWindow& window)
        : plane(across), samples(field, across), usual(window) {}
};

}  // namespace palpate::viewer
