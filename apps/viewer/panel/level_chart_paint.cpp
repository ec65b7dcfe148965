// Drawing of the level chart, and its curve by mouse and keys.
#include "apps/viewer/panel/level_chart.hpp"

#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>

#include <algorithm>
#include <cmath>
#include <map>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/inputs.hpp"

namespace palpate::viewer {
namespace {

QPainterPath triangle(double x, double tip, double base, double half) {
    QPainterPath path(QPointF(x, tip));
    path.lineTo(x - half, base);
    path.lineTo(x + half, base);
    path.closeSubpath();
    return path;
}

}  // namespace

void LevelChart::paint_ticks(QPainter& painter, const LevelAxis& axis) const {
    const QRectF p = plot();
    const double half = 0.2 * text_height();
    for (const double level : suggested_) {
        const double x = axis.x_of(level);
        painter.fillPath(triangle(x, p.top() - 1, p.top() - 2 * half, half),
                         palette().color(QPalette::Text));
        QColor faint = palette().color(QPalette::Text);
        faint.setAlphaF(0.35);
        painter.setPen(QPen(faint, 1, Qt::DotLine));
        painter.drawLine(QPointF(x, p.top()), QPointF(x, p.bottom()));
    }
}

void LevelChart::paint_marks(QPainter& painter, const LevelAxis& axis) const {
    const QRectF p = plot();
    const double half = 0.25 * text_height();
    int row = 0;
    for (const LevelMark& mark : marks_) {
        const double x = axis.x_of(mark.level);
        // Pale colours would vanish on white.
        const bool pale = !is_dark(palette()) && mark.colour.lightnessF() > 0.7;
        painter.setPen(QPen(pale ? mark.colour.darker(160) : mark.colour, 1.5));
        painter.drawLine(QPointF(x, p.top()), QPointF(x, p.bottom()));
        painter.setPen(QPen(palette().color(QPalette::Text), 1));
        painter.setBrush(mark.colour);
        painter.drawRect(QRectF(x - half, p.bottom() - 2 * half, 2 * half, 2 * half));
        if (mark.name.isEmpty()) continue;
        const double wide = fontMetrics().horizontalAdvance(mark.name);
        const double left = x + 3 + wide > p.right() ? x - 3 - wide : x + 3;
        // One below the other, so that names of near levels do not meet.
        const double top = p.top() + 1 + (row++ % 3) * text_height();
        painter.drawText(QRectF(left, top, wide + 1, text_height()), Qt::AlignLeft, mark.name);
    }
}

/// The level asked for as a line with a grip, the level felt as a broken line with a drop below.
void LevelChart::paint_markers(QPainter& painter, const LevelAxis& axis) const {
    const QRectF p = plot();
    if (!std::isnan(felt_)) {
        const QColor colour = readable(to_qt(pictures::scp_colour), palette());
        const double x = axis.x_of(felt_);
        painter.setPen(QPen(colour, 2, Qt::DashLine));
        painter.drawLine(QPointF(x, p.top()), QPointF(x, p.bottom()));
        const double half = 0.28 * text_height();
        painter.fillPath(triangle(x, p.bottom() - 1, p.bottom() + 1.6 * half, half), colour);
    }
    if (!level_shown_) return;
    const QColor colour = palette().color(hasFocus() ? QPalette::Highlight : QPalette::Text);
    const double x = axis.x_of(level_);
    painter.setPen(QPen(colour, 2));
    painter.drawLine(QPointF(x, p.top() - 1), QPointF(x, p.bottom()));
    const double half = 0.3 * text_height();
    painter.setPen(Qt::NoPen);
    painter.setBrush(colour);
    painter.drawRoundedRect(QRectF(x - half, p.top() - 1, 2 * half, 1.6 * half), 2, 2);
}

void LevelChart::paint_ends(QPainter& painter) const {
    const QRectF p = plot();
    const QRectF below(p.left(), strip().bottom() + 1, p.width(), text_height());
    painter.setPen(palette().color(QPalette::PlaceholderText));
    const LevelAxis a = axis();
    painter.drawText(below, Qt::AlignLeft | Qt::AlignVCenter, number_text(a.low));
    painter.drawText(below, Qt::AlignRight | Qt::AlignVCenter, number_text(a.high));
    if (!std::isfinite(felt_) && !std::isnan(felt_)) {
        painter.setPen(readable(to_qt(pictures::scp_colour), palette()));
        painter.drawText(below, Qt::AlignHCenter | Qt::AlignVCenter, tr("nothing is felt here"));
    }
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
    const LevelAxis a = axis();
    QColor bars = palette().color(QPalette::Text);
    bars.setAlphaF(isEnabled() ? 0.42 : 0.2);
    paint_histogram(painter, histogram_, a, p, bars);
    Ranges bands = level_shown_ ? bands_ : Ranges();
    if (hold_.part == Part::fresh) bands.push_back(fresh_);
    paint_bands(painter, bands, a, p, strip(), chosen_);
    paint_ticks(painter, a);
    paint_marks(painter, a);
    painter.setOpacity(isEnabled() ? 1 : 0.5);
    const QColor line = curve_.colours.empty() ? readable(QColor(0, 114, 178), palette())
                                               : palette().color(QPalette::Text);
    curve_.paint(painter, a, p, line, held_knot_);
    painter.setOpacity(1);
    paint_markers(painter, a);
    paint_ends(painter);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(palette().color(hasFocus() ? QPalette::Highlight : QPalette::Mid), 1));
    painter.drawRect(p);
}

void LevelChart::set_curve(const CurveLine& curve) {
    if (hold_.part == Part::knot) return;
    if (held_knot_ >= static_cast<int>(curve.knots.size())) held_knot_ = -1;
    curve_ = curve;
    update();
}

QPointF LevelChart::place_of(std::size_t knot) const {
    return curve_.place_of(curve_.knots.at(knot), axis(), plot());
}

void LevelChart::hold_knot(int knot) {
    held_knot_ = knot;
    update();
    Q_EMIT knot_held(knot);
}

void LevelChart::curve_edited() {
    Q_EMIT curve_changed(curve_.knots);
    hold_knot(held_knot_);
}

/// A second press holds a knot, too, and what there is to do with it is done if it is not dragged.
/// Elsewhere it makes another knot.
void LevelChart::mouseDoubleClickEvent(QMouseEvent* event) {
    const QPointF at = event->localPos();
    const bool left = event->button() == Qt::LeftButton && !curve_.knots.empty();
    const bool on_knot = hold_at(at).part == Part::knot;
    if (left && !on_knot && plot().contains(at)) {
        pressed_at_ = at;
        held_knot_ = curve_.add(curve_.knot_of(at, axis(), plot()));
        if (held_knot_ < 0) return;
        hold_ = {Part::knot, held_knot_};
        return curve_edited();
    }
    mousePressEvent(event);
    activates_ = left && on_knot;
}

/// The last ones stay: a curve without knots says nothing.
void LevelChart::remove_knot(int knot) {
    if (!curve_.remove(knot)) return;
    held_knot_ = -1;
    curve_edited();
}

/// Moves the held knot, or holds another. False: the key is for something else.
bool LevelChart::step_knot(int key, double steps) {
    const int count = static_cast<int>(curve_.knots.size());
    if (count == 0) return false;
    // A pixel is the finest that dragging has.
    const std::map<int, QPointF> ways{{Qt::Key_Left, {-steps, 0}},
                                      {Qt::Key_Right, {steps, 0}},
                                      {Qt::Key_Up, {0, -steps}},
                                      {Qt::Key_Down, {0, steps}}};
    const auto way = ways.find(key);
    const bool chooses = key == Qt::Key_PageDown || key == Qt::Key_PageUp;
    if (chooses || (held_knot_ < 0 && way != ways.end())) {
        const int next = held_knot_ + (key == Qt::Key_PageUp ? -1 : 1);
        hold_knot(held_knot_ < 0 ? 0 : std::clamp(next, 0, count - 1));
        return true;
    }
    if (held_knot_ < 0) return false;
    const auto held = static_cast<std::size_t>(held_knot_);
    const QPointF at = place_of(held);
    if (way != ways.end()) {
        curve_.put(held, curve_.knot_of(at + way->second, axis(), plot()), axis().step());
    } else if (key == Qt::Key_Insert) {
        // In the middle to the next one, or to the edge.
        const bool last = held + 1 == curve_.knots.size();
        const QPointF next = last ? QPointF(plot().right(), at.y()) : place_of(held + 1);
        const int added = curve_.add(curve_.knot_of(0.5 * (at + next), axis(), plot()));
        if (added < 0) return true;
        held_knot_ = added;
    } else if (key == Qt::Key_Return || key == Qt::Key_Enter) {
        Q_EMIT knot_activated(held_knot_);
        return true;
    } else {
        return false;
    }
    curve_edited();
    return true;
}

}  // namespace palpate::viewer
