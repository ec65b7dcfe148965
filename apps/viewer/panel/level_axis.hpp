// An axis of levels or times along a widget's width, with a histogram, and with ranges and curves
// that can be dragged.
#pragma once

#include <QColor>
#include <QRectF>
#include <QString>

#include <vector>

#include "apps/viewer/model/look.hpp"
#include "palpate/layers.hpp"
#include "palpate/proxy.hpp"
#include "palpate/run/statistics.hpp"

class QPainter;

namespace palpate::viewer {

/// low <= high [data units or s] lie at left < right [logical pixels].
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
};

/// The multiple of `unit`, a power of ten, that is nearest.
double rounded_to(double value, double unit);

/// The ends of the axis for a histogram: the data's, or round a single value.
LevelAxis axis_of(const run::Histogram& histogram, const QRectF& plot);

/// Bars, their heights the logarithms of the counts, on the plot's lower edge.
void paint_histogram(QPainter& painter, const run::Histogram& histogram, const LevelAxis& axis,
                     const QRectF& plot, const QColor& colour);

/// Ranges of interest, which are bands on a chart.
using Ranges = std::vector<DensityRange>;

/// The part of a range that is dragged.
enum class Grip { low, high, whole };

/// A range after its dragged part has moved: an end to the level, at most as far as the other end;
/// the whole by as much as `level` differs from `held_at`, within the axis. Ends at infinity stay.
DensityRange dragged(const DensityRange& start, Grip grip, double held_at, double level,
                     const LevelAxis& axis);

/// The colour of the band with this number, for chart and table.
QColor band_colour(int band);

using Knots = std::vector<Curve::Knot>;

/// A curve over levels, whose values are drawn from 0 to `top`.
struct CurveLine {
    Knots knots = {};
    double least = 1;   ///< of `top`, where all values are 0
    QString unit = {};  ///< of values; empty: none
    /// Of each knot; values are 0 to 1 then, and the area below is filled with them. Empty: none.
    std::vector<Colour> colours = {};
    std::size_t fewest = 1;  ///< knots that stay
    double top = 1;

    /// Leaves room above the highest value that is finite.
    void fit();
    /// A knot becomes another one, but stays between its neighbours, `gap` from them [data units].
    void put(std::size_t knot, Curve::Knot to, double gap);
    /// One more, at its place in the order; its number. -1: one has that level already.
    int add(const Curve::Knot& knot);
    /// False: it has to stay.
    bool remove(int knot);
};

}  // namespace palpate::viewer
