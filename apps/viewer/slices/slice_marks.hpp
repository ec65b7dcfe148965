// Marks over a slice: crosshair, hand and proxy, letters at the edges, texts in the corners.
#pragma once

#include <QPainter>
#include <QRegion>
#include <QString>

#include <vector>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/slices/plane.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

struct SliceSheet {
    const SlicePlane& plane;
    const SliceMap& map;
    double layer;
    QSizeF size;  ///< of the widget [pixels]

    /// Of a physical point [mm], seen along the grid axis.
    QPointF pixel(const Vec3& physical) const;
    /// How far it lies from the slice [mm].
    double distance(const Vec3& physical) const;
};

/// Lines through a pixel, open round it so that they hide nothing.
void paint_crosshair(QPainter& painter, const SliceSheet& sheet, const QPointF& at);

/// Hand, proxy, the spring between them and the force (green; a newton is an eighth of the widget's
/// height). Marks off the slice are paler the farther they are, but always visible. `name` stands
/// beside the hand.
void paint_probe(QPainter& painter, const SliceSheet& sheet, const Snapshot& snapshot,
                 const HandColours& colours, const QString& name);

/// Where the slice cuts a ball of this radius [mm] round a physical point.
void paint_brush(QPainter& painter, const SliceSheet& sheet, const Vec3& centre, double radius);

/// Points, lines between them and what they measure, paler off the slice.
void paint_measurement(QPainter& painter, const SliceSheet& sheet, const Measurement& measurement,
                       LengthUnit unit);

/// Words at an edge or in a corner.
struct SliceWords {
    Qt::Alignment where;
    QString text;
    bool bold = false;
};

/// Which side of the body is at each edge.
std::vector<SliceWords> letters_of(const SlicePlane& plane);
/// Where they are painted in a widget of this size.
QRegion place_of(const std::vector<SliceWords>& words, const QFont& font, const QSizeF& size);
void paint_words(QPainter& painter, const std::vector<SliceWords>& words, const QSizeF& size);

}  // namespace palpate::viewer
