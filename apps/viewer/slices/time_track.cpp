// Drawing and dragging the track.
#include "apps/viewer/slices/time_track.hpp"

#include <QFontMetrics>
#include <QHelpEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pictures/scene.hpp"

namespace palpate::viewer {
namespace {

QColor qt_colour(const pictures::Colour& c, double opacity = 1) {
    return QColor::fromRgbF(c.red, c.green, c.blue, opacity);
}

bool has_isovalue(const Overview::Piece& piece) {
    return piece.least_isovalue <= piece.most_isovalue;
}

/// What happened in the pieces under a pixel.
struct Column {
    double least_force = std::numeric_limits<double>::infinity(), most_force = 0;
    double least_isovalue = std::numeric_limits<double>::infinity();
    double most_isovalue = -std::numeric_limits<double>::infinity();
    bool empty = true;

    void take(const Overview::Piece& piece) {
        if (piece.empty) return;
        empty = false;
        least_force = std::min(least_force, piece.least_force);
        most_force = std::max(most_force, piece.most_force);
        if (!has_isovalue(piece)) return;
        least_isovalue = std::min(least_isovalue, piece.least_isovalue);
        most_isovalue = std::max(most_isovalue, piece.most_isovalue);
    }
};

}  // namespace

TimeTrack::TimeTrack(QWidget* parent) : QAbstractSlider(parent) {
    setObjectName("time_track");
    setAccessibleName(tr("Time of the recording [ms]"));
    setFocusPolicy(Qt::StrongFocus);
    setOrientation(Qt::Horizontal);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    setSingleStep(10);
    setMouseTracking(true);
}

void TimeTrack::set_overview(const Overview& overview) {
    overview_ = overview;
    most_force_ = 0;
    least_isovalue_ = std::numeric_limits<double>::infinity();
    most_isovalue_ = -least_isovalue_;
    for (const Overview::Piece& piece : overview_.pieces) {
        if (piece.empty) continue;
        most_force_ = std::max(most_force_, piece.most_force);
        if (!has_isovalue(piece)) continue;
        least_isovalue_ = std::min(least_isovalue_, piece.least_isovalue);
        most_isovalue_ = std::max(most_isovalue_, piece.most_isovalue);
    }
    const double milliseconds = std::min(std::ceil(1e3 * std::max(length(), 0.0)), 2e9);
    telling_ = false;
    setRange(0, static_cast<int>(milliseconds));
    telling_ = true;
    setPageStep(std::max(1, maximum() / 10));
    set_time(0);
}

void TimeTrack::set_time(double time) {
    time_ = std::clamp(std::isnan(time) ? 0 : time, 0.0, std::max(length(), 0.0));
    telling_ = false;
    setValue(static_cast<int>(std::lround(1e3 * time_)));
    telling_ = true;
    update();
}

/// Keys, and whatever else a slider is moved by, come in here.
void TimeTrack::sliderChange(SliderChange change) {
    QAbstractSlider::sliderChange(change);
    if (change != SliderValueChange || !telling_) return;
    time_ = std::min(1e-3 * value(), length());
    update();
    Q_EMIT chosen(time_);
}

QSize TimeTrack::sizeHint() const {
    const int height = QFontMetrics(font()).height();
    return {24 * height, 3 * height};
}

QSize TimeTrack::minimumSizeHint() const {
    const int height = QFontMetrics(font()).height();
    return {6 * height, 2 * height};
}

QRectF TimeTrack::plot() const {
    const double edge = 0.4 * QFontMetricsF(font()).height();
    return QRectF(rect()).adjusted(edge, 2, -edge, -2);
}

double TimeTrack::x_of(double time) const {
    const QRectF box = plot();
    return length() > 0 ? box.left() + box.width() * time / length() : box.left();
}

double TimeTrack::time_at(double x) const {
    const QRectF box = plot();
    return std::clamp((x - box.left()) / std::max(box.width(), 1.0), 0.0, 1.0) * length();
}

void TimeTrack::choose_at(double x) {
    set_time(time_at(x));
    Q_EMIT chosen(time_);
}

bool TimeTrack::event(QEvent* event) {
    if (event->type() == QEvent::ToolTip && !overview_.pieces.empty()) {
        const auto* const help = static_cast<QHelpEvent*>(event);
        const double time = time_at(help->pos().x());
        const auto at =
            std::min(static_cast<std::size_t>(time / overview_.width), overview_.pieces.size() - 1);
        const Overview::Piece& piece = overview_.pieces[at];
        QString words = tr("%1 s").arg(time, 0, 'f', 3);
        if (!piece.empty) words += tr("\nforce up to %1 N").arg(piece.most_force, 0, 'f', 2);
        if (!piece.empty && has_isovalue(piece)) {
            words += tr("\nisovalue %1").arg(piece.most_isovalue, 0, 'g', 6);
        }
        if (piece.contact) words += tr("\nin contact");
        QToolTip::showText(help->globalPos(), words, this);
        return true;
    }
    return QAbstractSlider::event(event);
}

void TimeTrack::paint_course(QPainter& painter, const QRectF& box) const {
    const int columns = std::max(1, static_cast<int>(box.width() * devicePixelRatioF()));
    const double step = box.width() / columns;
    const auto count = static_cast<double>(overview_.pieces.size());
    const double shown = length() > 0 ? length() / overview_.width : 1;  // pieces
    const double level_room = most_isovalue_ - least_isovalue_;
    painter.setPen(Qt::NoPen);
    for (int c = 0; c < columns; ++c) {
        const auto first = static_cast<std::size_t>(std::min(shown * c / columns, count - 1));
        const auto last = static_cast<std::size_t>(std::min(shown * (c + 1) / columns, count - 1));
        Column column;
        for (std::size_t i = first; i <= last; ++i) column.take(overview_.pieces[i]);
        if (column.empty) continue;
        const double x = box.left() + c * step;
        if (most_force_ > 0) {
            const double top = box.height() * column.most_force / most_force_;
            const double inner = box.height() * column.least_force / most_force_;
            const QColor colour = qt_colour(pictures::force_colour, 0.55);
            painter.fillRect(QRectF(x, box.bottom() - top, step, top), colour);
            painter.fillRect(QRectF(x, box.bottom() - inner, step, inner), colour);
        }
        if (level_room > 0 && column.least_isovalue <= column.most_isovalue) {
            const auto y = [&](double level) {
                return box.bottom() - 1 -
                       (box.height() - 2) * (level - least_isovalue_) / level_room;
            };
            const double high = y(column.most_isovalue), low = y(column.least_isovalue);
            painter.fillRect(QRectF(x, high - 0.75, step, low - high + 1.5),
                             palette().color(QPalette::Text));
        }
    }
}

void TimeTrack::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const QRectF box = plot();
    const QPalette colours = palette();
    painter.fillRect(box, colours.base());
    const double bar = std::max(3.0, 0.15 * box.height());
    if (!overview_.pieces.empty()) {
        paint_course(painter, box.adjusted(0, 2, 0, -bar - 2));
        for (const Overview::Interval& contact : overview_.contacts) {
            const double from = x_of(contact.from - overview_.begin);
            const double to = x_of(contact.to - overview_.begin);
            painter.fillRect(QRectF(from, box.bottom() - bar, std::max(to - from, 1.0), bar),
                             qt_colour(pictures::scp_colour));
        }
    }
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(
        QPen(hasFocus() ? colours.highlight().color() : colours.mid().color(), hasFocus() ? 2 : 1));
    painter.drawRect(box);
    if (overview_.pieces.empty()) return;
    const double x = x_of(time_), head = 0.35 * QFontMetricsF(font()).height();
    painter.setPen(QPen(colours.highlight().color(), 2));
    painter.drawLine(QPointF(x, box.top()), QPointF(x, box.bottom()));
    painter.setPen(QPen(colours.base().color(), 1));
    painter.setBrush(colours.highlight());
    painter.drawPolygon(QPolygonF({QPointF(x - head, box.top()), QPointF(x + head, box.top()),
                                   QPointF(x, box.top() + 1.6 * head)}));
}

void TimeTrack::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton || overview_.pieces.empty()) return event->ignore();
    setSliderDown(true);
    choose_at(event->localPos().x());
}

void TimeTrack::mouseMoveEvent(QMouseEvent* event) {
    if (isSliderDown()) choose_at(event->localPos().x());
}

void TimeTrack::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() == Qt::LeftButton) setSliderDown(false);
}

}  // namespace palpate::viewer
