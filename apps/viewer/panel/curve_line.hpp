// A curve over levels, drawn over the histogram, with knots to drag.
#pragma once

#include <QColor>
#include <QPointF>
#include <QRectF>
#include <QString>

#include <vector>

#include "apps/viewer/panel/level_axis.hpp"
#include "palpate/layers.hpp"

class QPainter;

namespace palpate::viewer {

using Knots = std::vector<Curve::Knot>;

/// Knots where they lie in a plot: levels along it, values from 0 on its lower edge to `top` on its
/// upper one.
struct CurveLine {
    Knots knots;
    double top = 1;
    double least = 1;   ///< of `top`, where all values are 0
    QString unit = {};  ///< of values; empty: none

    QPointF place_of(const Curve::Knot& knot, const LevelAxis& axis, const QRectF& plot) const;
    Curve::Knot knot_of(const QPointF& at, const LevelAxis& axis, const QRectF& plot) const;
    /// The knot within reach, or -1.
    int knot_at(const QPointF& at, const LevelAxis& axis, const QRectF& plot, double reach) const;
    /// To there, but between its neighbours.
    void move(std::size_t knot, const QPointF& to, const LevelAxis& axis, const QRectF& plot);
    /// One more, at its place in the order; its number. -1: one has that level already.
    int add(const Curve::Knot& knot);
    void paint(QPainter& painter, const LevelAxis& axis, const QRectF& plot, const QColor& colour,
               int chosen) const;
};

/// With room above the highest knot, up to `least` at least. Infinite values lie on the upper edge.
CurveLine line_of(const Knots& knots, double least = 1, const QString& unit = {});

}  // namespace palpate::viewer
