// Ranges of interest as bands on a level axis: finding the one under the pointer, dragging,
// drawing.
#pragma once

#include <QRectF>

#include <vector>

#include "apps/viewer/panel/level_axis.hpp"
#include "palpate/proxy.hpp"

class QPainter;

namespace palpate::viewer {

using Ranges = std::vector<DensityRange>;

/// The part of a band that is dragged.
enum class Grip { none, low, high, whole };
struct BandGrip {
    int band = -1;
    Grip grip = Grip::none;
};

/// The part under a pointer at x: the nearest end within `reach` pixels, else the band itself.
BandGrip band_at(const Ranges& ranges, const LevelAxis& axis, double x, double reach);

/// A range after its dragged part has moved: an end to the level, at most as far as the other end;
/// the whole by as much as `level` differs from `held_at`, within the axis. Ends at infinity stay.
DensityRange dragged(const DensityRange& start, Grip grip, double held_at, double level,
                     const LevelAxis& axis);

/// The colour of the band with this number, for chart and table.
QColor band_colour(int band);

/// Bands over the plot, with grips along `strip`, at its lower edge.
void paint_bands(QPainter& painter, const Ranges& ranges, const LevelAxis& axis, const QRectF& plot,
                 const QRectF& strip, int chosen);

}  // namespace palpate::viewer
