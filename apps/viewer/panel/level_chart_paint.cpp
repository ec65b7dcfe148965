// Drawing of the level chart.
#include <QLinearGradient>
#include <QPainter>
#include <QPainterPath>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/level_chart.hpp"

namespace palpate::viewer {
namespace {

QPainterPath triangle(double x, double tip, double base, double half) {
    QPainterPath path(QPointF(x, tip));
    path.lineTo(x - half, base);
    path.lineTo(x + half, base);
    path.closeSubpath();
    return path;
}

QPainterPath box(double x, double top, double height, double half, double round) {
    QPainterPath path;
    path.addRoundedRect(QRectF(x - half, top, 2 * half, height), round, round);
    return path;
}

QColor faint(QColor colour, double alpha) {
    colour.setAlphaF(alpha);
    return colour;
}

}  // namespace

void LevelChart::paint_bands(QPainter& painter) const {
    Ranges bands = have_level() ? bands_ : Ranges();
    if (new_band_) bands.push_back(*new_band_);
    const LevelAxis a = axis();
    const QRectF p = plot(), below = strip();
    for (std::size_t i = 0; i < bands.size(); ++i) {
        const auto band = static_cast<int>(i);
        const double low = a.x_of(bands[i].low), high = std::max(a.x_of(bands[i].high), low + 1);
        const QColor colour = band_colour(band);
        const QRectF grip(low, below.top(), high - low, below.height());
        painter.fillRect(QRectF(low, p.top(), high - low, p.height()), faint(colour, 0.28));
        painter.fillRect(grip, colour);
        painter.setPen(QPen(colour, 1));
        if (std::isfinite(bands[i].low)) painter.drawLine(QPointF(low, p.top()), grip.topLeft());
        if (std::isfinite(bands[i].high)) painter.drawLine(QPointF(high, p.top()), grip.topRight());
        if (band != band_) continue;
        painter.setPen(QPen(colour.darker(190), 1.5));
        painter.setBrush(Qt::NoBrush);
        painter.drawRect(grip.adjusted(0.75, 0.75, -0.75, -0.75));
    }
}

/// Levels worth feeling as dotted lines below a tick, those of layers and surfaces with a square,
/// the level felt as a broken line with a drop, the isovalue with a grip.
void LevelChart::paint_levels(QPainter& painter) const {
    const LevelAxis a = axis();
    const QRectF p = plot();
    const QColor text = palette().color(QPalette::Text);
    const double em = text_height();
    const auto line = [&](double x, const QPen& pen) {
        painter.setPen(pen);
        painter.drawLine(QPointF(x, p.top()), QPointF(x, p.bottom()));
    };
    for (const double level : suggested_) {
        const double x = a.x_of(level);
        line(x, QPen(faint(text, 0.35), 1, Qt::DotLine));
        painter.fillPath(triangle(x, p.top() - 1, p.top() - 0.4 * em, 0.2 * em), text);
    }
    int row = 0;
    for (const LevelMark& mark : marks_) {
        const double x = a.x_of(mark.level);
        line(x, QPen(readable(mark.colour, palette()), 1.5));
        const QPainterPath square = box(x, p.bottom() - 0.5 * em, 0.5 * em, 0.25 * em, 0);
        painter.fillPath(square, mark.colour);
        painter.strokePath(square, QPen(text, 1));
        if (mark.name.isEmpty()) continue;
        const double wide = fontMetrics().horizontalAdvance(mark.name);
        const double left = x + 3 + wide > p.right() ? x - 3 - wide : x + 3;
        // One below the other, so that names of near levels do not meet.
        const double top = p.top() + 1 + (row++ % 3) * em;
        painter.setPen(text);
        painter.drawText(QRectF(left, top, wide + 1, em), Qt::AlignLeft, mark.name);
    }
    if (!std::isnan(felt_)) {
        const QColor colour = readable(to_qt(pictures::scp_colour), palette());
        const double x = a.x_of(felt_);
        line(x, QPen(colour, 2, Qt::DashLine));
        painter.fillPath(triangle(x, p.bottom() - 1, p.bottom() + 0.45 * em, 0.28 * em), colour);
    }
    if (!have_level()) return;
    const QColor colour = hasFocus() ? palette().color(QPalette::Highlight) : text;
    line(a.x_of(level_), QPen(colour, 2));
    painter.fillPath(box(a.x_of(level_), p.top() - 1, 0.48 * em, 0.3 * em, 2), colour);
}

/// Constant beyond the outer knots; the chosen one with its value. The area below in the colours,
/// and these alone below it.
void LevelChart::paint_curve(QPainter& painter) const {
    if (curve_.knots.empty()) return;
    const QRectF p = plot();
    const bool coloured = !curve_.colours.empty();
    const QColor colour =
        coloured ? palette().color(QPalette::Text) : readable(QColor(0, 114, 178), palette());
    QPainterPath line(QPointF(p.left(), place_of(0).y()));
    QLinearGradient shades(p.left(), 0, p.right(), 0);
    for (std::size_t i = 0; i < curve_.knots.size(); ++i) {
        const QPointF at = place_of(i);
        line.lineTo(at);
        if (coloured) shades.setColorAt((at.x() - p.left()) / p.width(), to_qt(curve_.colours[i]));
    }
    line.lineTo(p.right(), line.currentPosition().y());
    const double opacity = isEnabled() ? 1 : 0.5;
    if (coloured) {
        QPainterPath area = line;
        area.lineTo(p.bottomRight());
        area.lineTo(p.bottomLeft());
        painter.setOpacity(0.75 * opacity);
        painter.fillPath(area, shades);
        painter.setOpacity(opacity);
        painter.fillRect(QRectF(p.left(), p.bottom() + 3, p.width(), 0.5 * text_height() - 3),
                         shades);
    }
    painter.setOpacity(opacity);
    painter.strokePath(line, QPen(colour, 1.5));
    painter.setPen(QPen(colour, 1.5));
    for (std::size_t i = 0; i < curve_.knots.size(); ++i) {
        const double radius = static_cast<int>(i) == knot_ ? 4.5 : 3;
        painter.setBrush(coloured ? to_qt(curve_.colours[i]) : colour);
        painter.drawEllipse(place_of(i), radius, radius);
    }
    if (knot_ >= 0) {
        const auto chosen = static_cast<std::size_t>(knot_);
        const QString text =
            (number_text(curve_.knots[chosen].value, 3) + " " + curve_.unit).trimmed();
        const QPointF at = place_of(chosen);
        const double wide = fontMetrics().horizontalAdvance(text);
        painter.drawText(QPointF(std::clamp(at.x() + 7, p.left(), p.right() - wide - 2),
                                 std::max(at.y() - 6, p.top() + text_height())),
                         text);
    }
    painter.setOpacity(1);
}

void LevelChart::paint_ends(QPainter& painter) const {
    const QRectF p = plot();
    const QRectF below(p.left(), strip().bottom() + 1, p.width(), text_height());
    painter.setPen(palette().color(QPalette::PlaceholderText));
    painter.drawText(below, Qt::AlignLeft | Qt::AlignVCenter, number_text(axis().low));
    painter.drawText(below, Qt::AlignRight | Qt::AlignVCenter, number_text(axis().high));
    if (!std::isfinite(felt_) && !std::isnan(felt_)) {
        painter.setPen(readable(to_qt(pictures::scp_colour), palette()));
        painter.drawText(below, Qt::AlignHCenter | Qt::AlignVCenter, tr("nothing is felt here"));
    }
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(palette().color(hasFocus() ? QPalette::Highlight : QPalette::Mid), 1));
    painter.drawRect(p);
}

void LevelChart::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QRectF p = plot();
    painter.fillRect(p, palette().color(QPalette::Base));
    if (histogram_.counts.empty()) {
        painter.setPen(palette().color(QPalette::PlaceholderText));
        painter.drawText(p, Qt::AlignCenter, tr("no volume"));
        return;
    }
    const QColor bars = faint(palette().color(QPalette::Text), isEnabled() ? 0.42 : 0.2);
    paint_histogram(painter, histogram_, axis(), p, bars);
    paint_bands(painter);
    paint_levels(painter);
    paint_curve(painter);
    paint_ends(painter);
}

}  // namespace palpate::viewer
