// Edits and draws a transfer function.
#include "apps/viewer/panel/transfer_editor.hpp"

#include <QKeyEvent>
#include <QLinearGradient>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/viewer/panel/colours.hpp"

namespace palpate::viewer {
namespace {

constexpr double point_reach = 8;  // [logical pixels] how near a pointer must come to hold a point
constexpr double radius = 5;       // [logical pixels] of a point

}  // namespace

TransferEditor::TransferEditor() {
    setObjectName("transfer_editor");
    setFocusPolicy(Qt::StrongFocus);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    setAccessibleName(tr("Transfer function"));
    setToolTip(tr(
        "Opacity (upwards, 0 to 1) and colour by level [data units].\n"
        "Drag a point; double click adds one, or on a point chooses its colour; right click or Del "
        "deletes.\nArrow keys move the chosen point, comma and period choose the next, Return its "
        "colour.\nChoose the preset again to undo. Ctrl-wheel zooms, shift-wheel moves, Ctrl+0 "
        "shows "
        "all again."));
}

void TransferEditor::set_data(const run::Histogram& histogram) {
    histogram_ = histogram;
    view_ = {};
    update();
}

void TransferEditor::set_transfer(const TransferFunction& transfer) {
    if (transfer == transfer_) return;
    transfer_ = transfer;
    dragging_ = false;
    if (chosen_ >= static_cast<int>(transfer_.points.size())) choose(-1);
    update();
    Q_EMIT point_chosen(chosen_);  // its numbers may be others now
}

void TransferEditor::choose(int point) {
    chosen_ = point;
    update();
    Q_EMIT point_chosen(chosen_);
}

QRectF TransferEditor::plot() const {
    const double strip = 0.5 * fontMetrics().height();
    return QRectF(rect()).adjusted(6, 6, -6, -(strip + 5));
}

LevelAxis TransferEditor::axis() const {
    return view_.seen(axis_of(histogram_, plot()));
}

QPointF TransferEditor::place_of(const ControlPoint& point) const {
    const QRectF p = plot();
    return {axis().x_of(point.level), p.bottom() - point.opacity * p.height()};
}

QSize TransferEditor::sizeHint() const {
    const int line = fontMetrics().height();
    return {18 * line, 7 * line};
}

QSize TransferEditor::minimumSizeHint() const {
    return {8 * fontMetrics().height(), sizeHint().height()};
}

int TransferEditor::point_at(const QPointF& at) const {
    int best = -1;
    double nearest = point_reach;
    for (std::size_t i = 0; i < transfer_.points.size(); ++i) {
        const QPointF off = place_of(transfer_.points[i]) - at;
        const double distance = std::hypot(off.x(), off.y());
        if (distance >= nearest) continue;
        nearest = distance;
        best = static_cast<int>(i);
    }
    return best;
}

/// Level and opacity at a place, with the colour that is there.
ControlPoint TransferEditor::under(const QPointF& at) const {
    const QRectF p = plot();
    ControlPoint point = sampled(transfer_, axis().round_level_of(at.x()));
    const double opacity = (p.bottom() - at.y()) / std::max(1.0, p.height());
    point.opacity = std::clamp(rounded_to(opacity, 0.01), 0.0, 1.0);
    return point;
}

void TransferEditor::edited() {
    transfer_.preset.clear();
    update();
    Q_EMIT changed(transfer_);
    Q_EMIT point_chosen(chosen_);
}

void TransferEditor::change_chosen(const ControlPoint& to) {
    if (chosen_ < 0) return;
    const auto at = static_cast<std::size_t>(chosen_);
    auto& points = transfer_.points;
    ControlPoint point = to;
    const double gap = 1e-4 * (axis().high - axis().low);
    const double low = at > 0 ? points[at - 1].level + gap : -std::numeric_limits<double>::max();
    const double high =
        at + 1 < points.size() ? points[at + 1].level - gap : std::numeric_limits<double>::max();
    // Between neighbours that are too close it stays where it is.
    point.level = low <= high ? std::clamp(to.level, low, high) : points[at].level;
    point.opacity = std::clamp(to.opacity, 0.0, 1.0);
    if (point == points[at]) return;
    points[at] = point;
    edited();
}

void TransferEditor::add(ControlPoint point) {
    auto& points = transfer_.points;
    if (points.size() < 2) return;
    const auto after = std::ranges::upper_bound(points, point.level, {}, &ControlPoint::level);
    if (after != points.begin() && (after - 1)->level == point.level) return;  // one is there
    const auto added = points.insert(after, point);
    chosen_ = static_cast<int>(added - points.begin());
    edited();
}

void TransferEditor::remove(int point) {
    auto& points = transfer_.points;
    if (point < 0 || points.size() <= 2) return;  // two are the least
    points.erase(points.begin() + point);
    chosen_ = -1;
    dragging_ = false;
    edited();
}

void TransferEditor::mousePressEvent(QMouseEvent* event) {
    const int point = point_at(event->localPos());
    if (event->button() == Qt::RightButton) return remove(point);
    if (event->button() != Qt::LeftButton) return;
    choose(point);
    dragging_ = point >= 0;
}

void TransferEditor::mouseMoveEvent(QMouseEvent* event) {
    if (!dragging_) return;
    ControlPoint to = under(event->localPos());
    to.colour = transfer_.points[static_cast<std::size_t>(chosen_)].colour;
    change_chosen(to);
}

void TransferEditor::mouseReleaseEvent(QMouseEvent*) {
    if (std::exchange(dragging_, false)) Q_EMIT settled();
}

void TransferEditor::mouseDoubleClickEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton) return;
    dragging_ = false;
    const int point = point_at(event->localPos());
    if (point < 0) return add(under(event->localPos()));
    choose(point);
    Q_EMIT colour_wanted(point);
}

void TransferEditor::keyPressEvent(QKeyEvent* event) {
    const int count = static_cast<int>(transfer_.points.size());
    if (count < 2) return QWidget::keyPressEvent(event);
    const auto moved = [&](double levels, double opacity) {
        if (chosen_ < 0) return choose(0);
        const double times = event->modifiers() & Qt::ShiftModifier ? 10 : 1;
        ControlPoint to = transfer_.points[static_cast<std::size_t>(chosen_)];
        to.level += times * levels;
        to.opacity = std::clamp(rounded_to(to.opacity + times * opacity, 0.001), 0.0, 1.0);
        change_chosen(to);
    };
    const double step = axis().step();
    switch (event->key()) {
        case Qt::Key_Left:
            return moved(-step, 0);
        case Qt::Key_Right:
            return moved(step, 0);
        case Qt::Key_Up:
            return moved(0, 0.01);
        case Qt::Key_Down:
            return moved(0, -0.01);
        case Qt::Key_Period:
            return choose((chosen_ + 1) % count);
        case Qt::Key_Comma:
            return choose((std::max(0, chosen_) + count - 1) % count);
        case Qt::Key_0:
            if (!(event->modifiers() & Qt::ControlModifier)) return event->ignore();
            view_ = {};
            return update();
        case Qt::Key_Delete:
        case Qt::Key_Backspace:
            return remove(chosen_);
        case Qt::Key_Insert: {
            // Half-way to the next one.
            const auto at = static_cast<std::size_t>(std::clamp(chosen_, 0, count - 2));
            const auto& points = transfer_.points;
            return add(sampled(transfer_, 0.5 * (points[at].level + points[at + 1].level)));
        }
        case Qt::Key_Return:
        case Qt::Key_Enter:
            if (chosen_ >= 0) Q_EMIT colour_wanted(chosen_);
            return;
        default:
            QWidget::keyPressEvent(event);
    }
}

void TransferEditor::wheelEvent(QWheelEvent* event) {
    event->setAccepted(view_.wheel(*event, axis_of(histogram_, plot())));
    if (event->isAccepted()) update();
}

/// The area under the opacity in the function's colours, the line over it, colours alone below.
void TransferEditor::paint_function(QPainter& painter) const {
    const QRectF p = plot();
    QLinearGradient colours(p.left(), 0, p.right(), 0);
    QPainterPath line(QPointF(p.left(), place_of(transfer_.points.front()).y()));
    for (const ControlPoint& point : transfer_.points) {
        const QPointF at = place_of(point);
        colours.setColorAt(std::clamp((at.x() - p.left()) / p.width(), 0.0, 1.0),
                           to_qt(point.colour));
        line.lineTo(at);
    }
    line.lineTo(p.right(), place_of(transfer_.points.back()).y());
    QPainterPath area = line;
    area.lineTo(p.bottomRight());
    area.lineTo(p.bottomLeft());
    area.closeSubpath();
    painter.setOpacity(isEnabled() ? 0.75 : 0.35);
    painter.fillPath(area, colours);
    painter.setOpacity(1);
    painter.setPen(QPen(palette().color(QPalette::Mid), 1));
    painter.setBrush(colours);
    painter.drawRect(QRectF(p.left(), p.bottom() + 2, p.width(), 0.5 * fontMetrics().height()));
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(palette().color(QPalette::Text), 1.5));
    painter.drawPath(line);
    for (std::size_t i = 0; i < transfer_.points.size(); ++i) {
        const bool chosen = static_cast<int>(i) == chosen_;
        painter.setBrush(to_qt(transfer_.points[i].colour));
        painter.setPen(QPen(palette().color(chosen ? QPalette::Highlight : QPalette::Text),
                            chosen ? 2.5 : 1.2));
        painter.drawEllipse(place_of(transfer_.points[i]), radius, radius);
    }
}

void TransferEditor::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QRectF p = plot();
    painter.fillRect(p, palette().color(QPalette::Base));
    QColor bars = palette().color(QPalette::Text);
    bars.setAlphaF(0.25);
    paint_histogram(painter, histogram_, axis(), p, bars);
    if (transfer_.points.size() >= 2) {
        paint_function(painter);
    } else {
        painter.setPen(palette().color(QPalette::PlaceholderText));
        painter.drawText(p, Qt::AlignCenter, tr("choose a preset"));
    }
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(palette().color(hasFocus() ? QPalette::Highlight : QPalette::Mid), 1));
    painter.drawRect(p);
}

}  // namespace palpate::viewer
