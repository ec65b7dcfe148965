// Draws crosshair, hand, proxy and texts over a slice.
#include "apps/viewer/slices/slice_marks.hpp"

#include <QCoreApplication>
#include <QFontMetricsF>
#include <QLineF>
#include <QPainterPath>

#include <algorithm>
#include <cmath>

#include "apps/viewer/model/look.hpp"

namespace palpate::viewer {
namespace {

QColor qt_colour(const pictures::Colour& c, double opacity = 1) {
    return QColor::fromRgbF(c.red, c.green, c.blue, opacity);
}

/// 1 on the slice, 0.25 far from it; half way at a hundredth of what is seen.
double opacity_of(const SliceSheet& sheet, const Vec3& physical) {
    const double half_mm = 0.03 * sheet.size.height() / sheet.map.per_mm;
    const double spacing = 0.5 * sheet.plane.grid.spacing[sheet.plane.axis];
    const double away = std::max(sheet.distance(physical) - spacing, 0.0) / half_mm;
    return 0.25 + 0.75 / (1 + away * away);
}

/// White below the colour, so that it is seen on black and on white.
void stroke(QPainter& painter, const QPainterPath& path, const QColor& colour, double width) {
    QPen pen(QColor::fromRgbF(1, 1, 1, 0.85 * colour.alphaF()), width + 2);
    pen.setCapStyle(Qt::RoundCap);
    pen.setJoinStyle(Qt::RoundJoin);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(pen);
    painter.drawPath(path);
    pen.setColor(colour);
    pen.setWidthF(width);
    painter.setPen(pen);
    painter.drawPath(path);
}

void dot(QPainter& painter, const QPointF& at, const QColor& colour, double radius) {
    painter.setPen(QPen(QColor::fromRgbF(1, 1, 1, 0.9 * colour.alphaF()), 1));
    painter.setBrush(colour);
    painter.drawEllipse(at, radius, radius);
}

/// A zigzag from one point to another, straight where there is no room for one.
QPainterPath spring(const QPointF& from, const QPointF& to, double width) {
    QPainterPath path(from);
    const QLineF line(from, to);
    constexpr int turns = 6;
    if (line.length() > 4 * width) {
        const QPointF along = (to - from) / line.length(), across(-along.y(), along.x());
        for (int i = 1; i < 2 * turns; ++i) {
            const double part = 0.15 + 0.7 * i / (2 * turns);
            path.lineTo(line.pointAt(part) + (i % 2 ? width : -width) * across);
        }
    }
    path.lineTo(to);
    return path;
}

QPainterPath arrow(const QPointF& from, const QPointF& to, double head) {
    QPainterPath path(from);
    path.lineTo(to);
    const double length = QLineF(from, to).length();
    const QPointF along = (to - from) / length, across(-along.y(), along.x());
    const double size = std::min(head, 0.6 * length);
    path.moveTo(to - size * along + 0.6 * size * across);
    path.lineTo(to);
    path.lineTo(to - size * along - 0.6 * size * across);
    return path;
}

void paint_force(QPainter& painter, const SliceSheet& sheet, const Snapshot& snapshot,
                 double opacity, double unit) {
    const SessionTick& tick = snapshot.session;
    const Vec3 force = tick.transform.rotation * tick.tick.force;
    const double newtons = force.norm();
    if (!(newtons > 1e-3)) return;
    const double length = std::clamp(0.125 * newtons, 0.05, 0.35) * sheet.size.height();
    const Vec3& scp = tick.tick.proxy.scp;
    const QPointF from = sheet.pixel(scp);
    const QPointF to = sheet.pixel(scp + (length / sheet.map.per_mm / newtons) * force);
    if (QLineF(from, to).length() < 0.5 * unit) return;  // it points at the viewer
    stroke(painter, arrow(from, to, 1.2 * unit), qt_colour(pictures::force_colour, opacity),
           0.3 * unit);
}

void shadowed(QPainter& painter, const QRectF& box, int flags, const QString& text) {
    painter.setPen(QColor(0, 0, 0, 200));
    painter.drawText(box.translated(1, 1), flags, text);
    painter.drawText(box.translated(-0.5, 0.5), flags, text);
    painter.setPen(QColor(230, 230, 230));
    painter.drawText(box, flags, text);
}

}  // namespace

QPointF SliceSheet::pixel(const Vec3& physical) const {
    const Vec3 at = plane.point(physical);
    return map.pixel(at[0], at[1]);
}

double SliceSheet::distance(const Vec3& physical) const {
    return std::abs(plane.point(physical)[2] - layer) * plane.grid.spacing[plane.axis];
}

void paint_crosshair(QPainter& painter, const SliceSheet& sheet, const QPointF& at) {
    const double gap = 0.8 * QFontMetricsF(painter.font()).height();
    const double right = sheet.size.width(), bottom = sheet.size.height();
    const QVector<QLineF> lines{{0, at.y(), at.x() - gap, at.y()},
                                {at.x() + gap, at.y(), right, at.y()},
                                {at.x(), 0, at.x(), at.y() - gap},
                                {at.x(), at.y() + gap, at.x(), bottom}};
    painter.setPen(QPen(QColor(0, 0, 0, 110), 3));
    painter.drawLines(lines);
    painter.setPen(QPen(QColor(240, 228, 66, 190), 1));
    painter.drawLines(lines);
}

void paint_probe(QPainter& painter, const SliceSheet& sheet, const Snapshot& snapshot,
                 const HandColours& colours, const QString& name) {
    const ProxyUpdate& proxy = snapshot.session.tick.proxy;
    if (!proxy.hip.allFinite() || !proxy.scp.allFinite()) return;
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    const double unit = 0.6 * QFontMetricsF(painter.font()).height();
    const double hip_opacity = opacity_of(sheet, proxy.hip);
    const double scp_opacity = opacity_of(sheet, proxy.scp);
    const QPointF hip = sheet.pixel(proxy.hip), scp = sheet.pixel(proxy.scp);
    const bool apart = proxy.hip != proxy.scp;
    if (apart && QLineF(hip, scp).length() > 1) {
        const double opacity = std::min(hip_opacity, scp_opacity);
        stroke(painter, spring(hip, scp, 0.4 * unit), qt_colour(pictures::spring_colour, opacity),
               0.15 * unit);
    }
    paint_force(painter, sheet, snapshot, scp_opacity, unit);
    if (apart) dot(painter, scp, qt_colour(colours.scp, scp_opacity), 0.5 * unit);
    dot(painter, hip, qt_colour(colours.hip, hip_opacity), 0.5 * unit);
    painter.setOpacity(hip_opacity);
    const double em = QFontMetricsF(painter.font()).height();
    shadowed(painter, QRectF(hip + QPointF(0.4 * em, 0.1 * em), QSizeF(2 * em, em)),
             Qt::AlignLeft | Qt::AlignVCenter, name);
    painter.restore();
}

void paint_brush(QPainter& painter, const SliceSheet& sheet, const Vec3& centre, double radius) {
    const double away = centre.allFinite() ? sheet.distance(centre) : radius;
    if (!(away < radius)) return;
    const double cut = std::sqrt(radius * radius - away * away) * sheet.map.per_mm;
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    QPainterPath circle;
    circle.addEllipse(sheet.pixel(centre), cut, cut);
    stroke(painter, circle, qt_colour(brush_colour), 1.5);
    painter.restore();
}

void paint_measurement(QPainter& painter, const SliceSheet& sheet, const Measurement& m,
                       LengthUnit unit) {
    if (m.points.empty()) return;
    const QColor yellow(242, 217, 26);
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    double opacity = 1;
    QPainterPath path(sheet.pixel(m.points.front()));
    for (const Vec3& p : m.points) {
        opacity = std::min(opacity, opacity_of(sheet, p));
        path.lineTo(sheet.pixel(p));
    }
    QColor faint = yellow;
    faint.setAlphaF(opacity);
    painter.setPen(QPen(QColor::fromRgbF(0, 0, 0, 0.6 * opacity), 3.5));
    painter.drawPath(path);
    painter.setPen(QPen(faint, 1.5));
    painter.drawPath(path);
    for (const Vec3& p : m.points) {
        QColor colour = yellow;
        colour.setAlphaF(opacity_of(sheet, p));
        dot(painter, sheet.pixel(p), colour, 3);
    }
    const std::string words =
        text_of(m, unit, QCoreApplication::translate("Units", "voxel").toStdString());
    if (!words.empty()) {
        const QPointF at = m.kind == Measure::length
                               ? 0.5 * (sheet.pixel(m.points[0]) + sheet.pixel(m.points[1]))
                               : sheet.pixel(m.points[1]);
        const double em = QFontMetricsF(painter.font()).height();
        painter.setOpacity(opacity);
        shadowed(painter, QRectF(at + QPointF(8, -1.2 * em), QSizeF(12 * em, em)),
                 Qt::AlignLeft | Qt::AlignVCenter, QString::fromStdString(words));
    }
    painter.restore();
}

namespace {

QFont font_of(const SliceWords& words, QFont font) {
    font.setBold(words.bold);
    return font;
}

QRectF box_in(const QSizeF& size, const QFont& font) {
    const double edge = 0.3 * QFontMetricsF(font).height();
    return QRectF({0, 0}, size).adjusted(edge, edge, -edge, -edge);
}

}  // namespace

std::vector<SliceWords> letters_of(const SlicePlane& plane) {
    const auto text = [](const std::string& letters) { return QString::fromStdString(letters); };
    return {{Qt::AlignLeft | Qt::AlignVCenter, text(plane.at_left), true},
            {Qt::AlignRight | Qt::AlignVCenter, text(plane.at_right), true},
            {Qt::AlignHCenter | Qt::AlignTop, text(plane.at_top), true},
            {Qt::AlignHCenter | Qt::AlignBottom, text(plane.at_bottom), true}};
}

QRegion place_of(const std::vector<SliceWords>& words, const QFont& font, const QSizeF& size) {
    QRegion places;
    for (const SliceWords& one : words) {
        const QFontMetricsF metrics(font_of(one, font));
        const QRectF box = box_in(size, font_of(one, font));
        places += metrics.boundingRect(box, static_cast<int>(one.where), one.text).toAlignedRect();
    }
    return places;
}

void paint_words(QPainter& painter, const std::vector<SliceWords>& words, const QSizeF& size) {
    painter.save();
    const QFont font = painter.font();
    for (const SliceWords& one : words) {
        painter.setFont(font_of(one, font));
        shadowed(painter, box_in(size, painter.font()), static_cast<int>(one.where), one.text);
    }
    painter.restore();
}

}  // namespace palpate::viewer
