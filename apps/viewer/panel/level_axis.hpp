// An axis of levels along a widget's width, with the histogram over it. Shared by the level chart
// and the transfer function editor.
#pragma once

#include <QColor>
#include <QPalette>
#include <QRectF>

#include "palpate/run/statistics.hpp"

class QPainter;
class QWheelEvent;

namespace palpate::viewer {

/// low < high [data units] lie at left < right [logical pixels].
struct LevelAxis {
    double low = 0, high = 1;
    double left = 0, right = 1;

    double x_of(double level) const;  ///< infinite levels at the ends
    double level_of(double x) const;  ///< not beyond the ends
    /// A power of ten, at most what a pixel is: dragged levels are multiples of it, which makes
    /// their numbers short.
    double step() const;
    /// The multiple of step() nearest to the level at x, not beyond the ends.
    double round_level_of(double x) const;
};

/// The part of the data that is seen, 0 <= from < to <= 1 of its whole axis.
struct LevelView {
    double from = 0, to = 1;

    /// The axis of that part, between the same pixels.
    LevelAxis seen(const LevelAxis& whole) const;
    /// `factor` > 1 shows less of the data in more detail; `about`, 0 to 1 of the whole, stays
    /// where it is as long as the ends allow.
    void zoom(double factor, double about);
    /// Moves by a part of the visible range.
    void move(double part);
    /// Control and wheel zooms about the pointer, shift and wheel moves. False: neither is held.
    bool wheel(const QWheelEvent& event, const LevelAxis& whole);
};

/// The multiple of `unit`, a power of ten, that is nearest.
double rounded_to(double value, double unit);

/// The ends of the axis for a histogram: the data's, or round a single value.
LevelAxis axis_of(const run::Histogram& histogram, const QRectF& plot);

/// Bars, their heights the logarithms of the counts, on the plot's lower edge.
void paint_histogram(QPainter& painter, const run::Histogram& histogram, const LevelAxis& axis,
                     const QRectF& plot, const QColor& colour);

/// Whether the palette is dark.
bool is_dark(const QPalette& palette);
/// The colour, lighter on a dark palette: thin lines and small text stay readable.
QColor readable(const QColor& colour, const QPalette& palette);

}  // namespace palpate::viewer
