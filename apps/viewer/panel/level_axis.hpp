// An axis of levels along a widget's width, with histogram, bands and a curve over it.
#pragma once

#include <QColor>
#include <QPalette>
#include <QPointF>
#include <QRectF>
#include <QString>

#include <vector>

#include "apps/viewer/model/look.hpp"
#include "palpate/layers.hpp"
#include "palpate/proxy.hpp"
#include "palpate/run/statistics.hpp"

class QPainter;
class QPainterPath;
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

bool is_dark(const QPalette& palette);
/// The colour, lighter on a dark palette: thin lines and small text stay readable.
QColor readable(const QColor& colour, const QPalette& palette);

// Ranges of interest as bands on a level axis: finding the one under the pointer, dragging,
// drawing.
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

// A curve over levels, drawn over the histogram, with knots to drag.
using Knots = std::vector<Curve::Knot>;

/// Knots where they lie in a plot: levels along it, values from 0 on its lower edge to `top` on its
/// upper one.
struct CurveLine {
    Knots knots;
    double top = 1;
    double least = 1;   ///< of `top`, where all values are 0
    QString unit = {};  ///< of values; empty: none
    /// Of each knot; `top` stays then, and the area below is filled with them. Empty: none.
    std::vector<Colour> colours = {};
    std::size_t fewest = 1;  ///< knots that stay

    QPointF place_of(const Curve::Knot& knot, const LevelAxis& axis, const QRectF& plot) const;
    Curve::Knot knot_of(const QPointF& at, const LevelAxis& axis, const QRectF& plot) const;
    /// The nearest knot within reach, or -1.
    int knot_at(const QPointF& at, const LevelAxis& axis, const QRectF& plot, double reach) const;
    /// A knot becomes another one, but stays between its neighbours, `gap` from them [data units].
    void put(std::size_t knot, Curve::Knot to, double gap);
    /// One more, at its place in the order; its number. -1: one has that level already.
    int add(const Curve::Knot& knot);
    /// False: it has to stay.
    bool remove(int knot);
    void paint(QPainter& painter, const LevelAxis& axis, const QRectF& plot, const QColor& colour,
               int chosen) const;

  private:
    void fill(QPainter& painter, const QPainterPath& line, const LevelAxis& axis,
              const QRectF& plot) const;
};

/// With room above the highest knot, up to `least` at least. Infinite values lie on the upper edge.
CurveLine line_of(const Knots& knots, double least = 1, const QString& unit = {});

}  // namespace palpate::viewer
