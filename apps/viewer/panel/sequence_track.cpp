// Drawing and dragging the track.
#include "apps/viewer/panel/sequence_track.hpp"

#include <QFontMetrics>
#include <QHelpEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QSignalBlocker>
#include <QToolTip>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::viewer {
namespace {

constexpr double least_between_ticks = 3;  // pixels

/// As many as tell one frame from the next, and two at least.
int digits_for(const SequenceView& view) {
    if (view.frames.size() < 2) return 2;
    const double apart =
        (view.frames.back() - view.frames.front()) / static_cast<double>(view.frames.size() - 1);
    if (!(apart > 0)) return 2;
    return std::clamp(1 - static_cast<int>(std::floor(std::log10(apart))), 2, 9);
}

}  // namespace

SequenceTrack::SequenceTrack(QWidget* parent) : QAbstractSlider(parent) {
    setObjectName("sequence_track");
    setAccessibleName(tr("Time of the sequence [ms]"));
    setAccessibleDescription(tr("Arrows go from frame to frame"));
    setFocusPolicy(Qt::StrongFocus);
    setOrientation(Qt::Horizontal);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

double SequenceTrack::length() const {
    return std::max(view_.end - view_.begin, 0.0);
}

bool SequenceTrack::set_view(const SequenceView& view) {
    const bool other = view.begin != view_.begin || view.end != view_.end ||
                       view.live != view_.live || view.frames != view_.frames;
    const bool seen = other || view.loop != view_.loop || view.loaded_from != view_.loaded_from ||
                      view.loaded_to != view_.loaded_to;
    if (other) {
        const QSignalBlocker quiet(this);  // a drag that ends by this asks for nothing
        view_ = view;
        digits_ = digits_for(view);
        const double milliseconds = std::min(std::ceil(1e3 * length()), 2e9);
        telling_ = false;
        setRange(0, static_cast<int>(milliseconds));
        telling_ = true;
        setSingleStep(std::max(1, maximum() / 100));
        setPageStep(std::max(1, maximum() / 10));
        setEnabled(!view.live && length() > 0);
        time_ = within(view_, time_);
        place();
    } else if (seen) {
        view_.loop = view.loop;
        view_.loaded_from = view.loaded_from;
        view_.loaded_to = view.loaded_to;
    }
    if (seen) update();
    return other;
}

void SequenceTrack::set_time(double time) {
    const double to = within(view_, time);
    if (to == time_) return;
    time_ = to;
    place();
    update();
}

/// The slider's value at the time.
void SequenceTrack::place() {
    telling_ = false;
    setValue(static_cast<int>(std::lround(std::min(1e3 * (time_ - view_.begin), 2e9))));
    telling_ = true;
}

/// Keys, and whatever else a slider is moved by, come in here.
void SequenceTrack::sliderChange(SliderChange change) {
    QAbstractSlider::sliderChange(change);
    if (change != SliderValueChange || !telling_) return;
    time_ = view_.begin + std::min(1e-3 * value(), length());
    update();
    Q_EMIT chosen(time_);
}

QString SequenceTrack::text_at(double time) const {
    const QString seconds = tr("%1 s").arg(time, 0, 'f', digits_);
    if (view_.live) return tr("%1, live").arg(seconds);
    const auto frame = frame_at(view_, time);
    if (!frame) return {};
    return tr("%1, frame %2 of %3").arg(seconds).arg(*frame + 1).arg(view_.frames.size());
}

QSize SequenceTrack::sizeHint() const {
    const int height = QFontMetrics(font()).height();
    return {24 * height, 2 * height};
}

QSize SequenceTrack::minimumSizeHint() const {
    const int height = QFontMetrics(font()).height();
    return {6 * height, 2 * height};
}

QRectF SequenceTrack::plot() const {
    const double edge = 0.4 * QFontMetricsF(font()).height();
    return QRectF(rect()).adjusted(edge, 2, -edge, -2);
}

double SequenceTrack::x_of(double time) const {
    const QRectF box = plot();
    return length() > 0 ? box.left() + box.width() * (time - view_.begin) / length() : box.left();
}

double SequenceTrack::time_at(double x) const {
    const QRectF box = plot();
    const double part = std::clamp((x - box.left()) / std::max(box.width(), 1.0), 0.0, 1.0);
    return part == 1 ? view_.end : view_.begin + part * length();
}

void SequenceTrack::choose_at(double x) {
    set_time(time_at(x));
    Q_EMIT chosen(time_);
}

bool SequenceTrack::event(QEvent* event) {
    if (event->type() == QEvent::ToolTip && !view_.frames.empty() && !view_.live) {
        const auto* const help = static_cast<QHelpEvent*>(event);
        QToolTip::showText(help->globalPos(), text_at(time_at(help->pos().x())), this);
        return true;
    }
    return QAbstractSlider::event(event);
}

/// A line a frame; where they would run together, fewer.
void SequenceTrack::paint_frames(QPainter& painter, const QRectF& box) const {
    QColor colour = palette().color(QPalette::Text);
    colour.setAlphaF(0.6);
    painter.setPen(QPen(colour, 1));
    double last = -std::numeric_limits<double>::infinity();
    for (const double frame : view_.frames) {
        const double x = x_of(frame);
        if (x - last < least_between_ticks || x > box.right() + 0.5) continue;
        painter.drawLine(QPointF(x, box.bottom() - 0.4 * box.height()), QPointF(x, box.bottom()));
        last = x;
    }
}

void SequenceTrack::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const QRectF box = plot();
    const QPalette colours = palette();
    painter.fillRect(box, colours.base());
    if (!view_.live) {
        QColor loaded = colours.color(QPalette::Highlight);
        loaded.setAlphaF(0.4);
        for (const Stretch& one : loaded_stretches(view_)) {
            const double from = x_of(one.from), to = x_of(one.to);
            painter.fillRect(QRectF(from, box.top(), std::max(to - from, 2.0), box.height()),
                             loaded);
        }
        paint_frames(painter, box);
    }
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(
        QPen(hasFocus() ? colours.highlight().color() : colours.mid().color(), hasFocus() ? 2 : 1));
    painter.drawRect(box);
    if (!isEnabled()) return;
    const double x = x_of(time_), head = 0.35 * QFontMetricsF(font()).height();
    painter.setPen(QPen(colours.text().color(), 2));
    painter.drawLine(QPointF(x, box.top()), QPointF(x, box.bottom()));
    painter.setPen(QPen(colours.base().color(), 1));
    painter.setBrush(colours.text());
    painter.drawPolygon(QPolygonF({QPointF(x - head, box.top()), QPointF(x + head, box.top()),
                                   QPointF(x, box.top() + 1.6 * head)}));
}

void SequenceTrack::keyPressEvent(QKeyEvent* event) {
    switch (event->key()) {
        case Qt::Key_Right:
        case Qt::Key_Up:
            Q_EMIT stepped(1);
            return;
        case Qt::Key_Left:
        case Qt::Key_Down:
            Q_EMIT stepped(-1);
            return;
        default:
            QAbstractSlider::keyPressEvent(event);
    }
}

void SequenceTrack::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton) return event->ignore();
    setSliderDown(true);
    choose_at(event->localPos().x());
}

void SequenceTrack::mouseMoveEvent(QMouseEvent* event) {
    if (isSliderDown()) choose_at(event->localPos().x());
}

void SequenceTrack::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() == Qt::LeftButton) setSliderDown(false);
}

}  // namespace palpate::viewer
