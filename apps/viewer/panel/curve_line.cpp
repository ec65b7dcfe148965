// Places, moves and draws knots.
#include "apps/viewer/panel/curve_line.hpp"

#include <QPainter>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/number_box.hpp"

namespace palpate::viewer {

CurveLine line_of(const Knots& knots, double least, const QString& unit) {
    constexpr double room = 1.25;
    double highest = 0;
    for (const Curve::Knot& knot : knots) {
        if (std::isfinite(knot.value)) highest = std::max(highest, knot.value);
    }
    return {knots, highest > 0 ? room * highest : least, least, unit};
}

QPointF CurveLine::place_of(const Curve::Knot& knot, const LevelAxis& axis,
                            const QRectF& plot) const {
    const double part = std::clamp(knot.value / top, 0.0, 1.0);
    return {axis.x_of(knot.at), plot.bottom() - part * plot.height()};
}

Curve::Knot CurveLine::knot_of(const QPointF& at, const LevelAxis& axis, const QRectF& plot) const {
    const double part = std::clamp((plot.bottom() - at.y()) / plot.height(), 0.0, 1.0);
    const double digit = std::pow(10.0, std::floor(std::log10(top)) - 2);  // short numbers
    return {axis.round_level_of(at.x()), std::round(part * top / digit) * digit};
}

int CurveLine::knot_at(const QPointF& at, const LevelAxis& axis, const QRectF& plot,
                       double reach) const {
    for (std::size_t i = 0; i < knots.size(); ++i) {
        const QPointF away = place_of(knots[i], axis, plot) - at;
        if (std::hypot(away.x(), away.y()) <= reach) return static_cast<int>(i);
    }
    return -1;
}

void CurveLine::move(std::size_t knot, const QPointF& to, const LevelAxis& axis,
                     const QRectF& plot) {
    Curve::Knot moved = knot_of(to, axis, plot);
    const double gap = axis.step();
    const bool past_left = knot > 0 && !(moved.at >= knots[knot - 1].at + gap);
    const bool past_right = knot + 1 < knots.size() && !(moved.at <= knots[knot + 1].at - gap);
    if (past_left || past_right) moved.at = knots[knot].at;
    knots[knot] = moved;
}

int CurveLine::add(const Curve::Knot& knot) {
    const auto behind =
        std::ranges::find_if(knots, [&](const Curve::Knot& one) { return one.at >= knot.at; });
    if (behind != knots.end() && behind->at == knot.at) return -1;
    const auto number = static_cast<int>(behind - knots.begin());
    knots.insert(behind, knot);
    return number;
}

/// Constant beyond the outer knots; the chosen one with its value.
void CurveLine::paint(QPainter& painter, const LevelAxis& axis, const QRectF& plot,
                      const QColor& colour, int chosen) const {
    if (knots.empty()) return;
    painter.save();
    painter.setClipRect(plot);
    painter.setPen(QPen(colour, 1.5));
    QPointF last(plot.left(), place_of(knots.front(), axis, plot).y());
    for (const Curve::Knot& knot : knots) {
        const QPointF at = place_of(knot, axis, plot);
        painter.drawLine(last, at);
        last = at;
    }
    painter.drawLine(last, QPointF(plot.right(), last.y()));
    painter.setBrush(colour);
    for (std::size_t i = 0; i < knots.size(); ++i) {
        const QPointF at = place_of(knots[i], axis, plot);
        const double radius = static_cast<int>(i) == chosen ? 4.5 : 3;
        painter.drawEllipse(at, radius, radius);
        if (static_cast<int>(i) != chosen) continue;
        QString text = number_text(knots[i].value, 3);
        if (!unit.isEmpty()) text += " " + unit;
        const double wide = painter.fontMetrics().horizontalAdvance(text);
        const double x = std::clamp(at.x() + 7, plot.left(), plot.right() - wide - 2);
        painter.drawText(
            QPointF(x, std::max(at.y() - 6, plot.top() + painter.fontMetrics().height())), text);
    }
    painter.restore();
}

}  // namespace palpate::viewer
