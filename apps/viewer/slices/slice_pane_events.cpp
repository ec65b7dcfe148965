// Mouse, wheel and key input of a slice pane.
#include <QHelpEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QToolTip>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>

#include "apps/viewer/slices/slice_content.hpp"

namespace palpate::viewer {
namespace {

constexpr double least_zoom = 0.2, most_zoom = 200;
/// The narrowest window, as a part of the data's range.
constexpr double narrowest = 1e-4;

}  // namespace

bool SlicePane::event(QEvent* event) {
    // A tip over the picture would hide it: only over the words in the corner.
    if (event->type() == QEvent::ToolTip) {
        const auto* const help = static_cast<QHelpEvent*>(event);
        const int words = 5 * fontMetrics().height();
        if (help->pos().x() < words && help->pos().y() < words) {
            QToolTip::showText(help->globalPos(), whatsThis(), this);
        } else {
            QToolTip::hideText();
            event->ignore();
        }
        return true;
    }
    return QWidget::event(event);
}

void SlicePane::choose(const Vec3& physical) {
    set_crosshair(physical);
    Q_EMIT crosshair_chosen(crosshair_);
}

/// The nearest point in the data.
void SlicePane::choose_at(const QPointF& pixel) {
    const QPointF at = map().sample(pixel);
    const SliceSamples& samples = content_->samples;
    const Vec3 slice(std::clamp(at.x(), 0.0, samples.width() - 1.0),
                     std::clamp(at.y(), 0.0, samples.height() - 1.0), layer());
    choose(physical_from_index(geometry(), index_from_slice(content_->plane, geometry(), slice)));
}

void SlicePane::aim_at(const QPointF& pixel) {
    const QPointF at = map().sample(pixel);
    const Vec3 slice(at.x(), at.y(), drag_layer_);
    Q_EMIT probe_aimed(
        physical_from_index(geometry(), index_from_slice(content_->plane, geometry(), slice)));
}

/// Whole layers, up towards the patient's left, back or head.
double SlicePane::next_layer(double from, int steps) const {
    if (geometry().direction(content_->plane.anatomical, axis_) < 0) steps = -steps;
    constexpr double hair = 1e-6;
    const double layer =
        steps > 0 ? std::floor(from + hair) + steps : std::ceil(from - hair) + steps;
    return std::clamp(layer, 0.0, geometry().size[axis_] - 1.0);
}

void SlicePane::step_slice(int steps) {
    Vec3 index = index_from_physical(geometry(), crosshair_);
    index[axis_] = next_layer(index[axis_], steps);
    choose(physical_from_index(geometry(), index));
}

/// What is at the pixel stays there.
void SlicePane::zoom_at(const QPointF& pixel, double factor) {
    const double zoom = std::clamp(view_.zoom * factor, least_zoom, most_zoom);
    const QPointF at = map().sample(pixel);
    view_.zoom = zoom;
    const SliceMap now = map();
    view_.moved += (pixel - now.pixel(at.x(), at.y())) / now.per_mm;
    picture_changed();
}

/// The pane's width is the data's range.
void SlicePane::change_window(const QPointF& drag) {
    const double range = content_->samples.field().volume().range();
    const double per_pixel = range / std::max(width(), 100);
    const double wide = std::max(high_ - low_ + drag.x() * per_pixel, narrowest * range);
    const double level = std::clamp(0.5 * (low_ + high_) - drag.y() * per_pixel,
                                    content_->samples.field().volume().minimum() - range,
                                    content_->samples.field().volume().maximum() + range);
    use_window(level - 0.5 * wide, level + 0.5 * wide);
    Q_EMIT window_changed(low_, high_);
}

void SlicePane::reset() {
    view_ = {};
    use_window(content_->usual.low, content_->usual.high);
    picture_changed();
    Q_EMIT window_changed(low_, high_);
}

void SlicePane::mousePressEvent(QMouseEvent* event) {
    if (!content_ || drag_ != Drag::none) return;
    drag_from_ = event->localPos();
    if (event->button() == Qt::LeftButton) {
        if (probe_ && !(event->modifiers() & Qt::ControlModifier)) {
            drag_ = Drag::probe;
            drag_layer_ = layer();
            aim_at(event->localPos());
        } else {
            drag_ = Drag::crosshair;
            choose_at(event->localPos());
        }
    } else if (event->button() == Qt::RightButton) {
        drag_ = Drag::window;
    } else if (event->button() == Qt::MiddleButton) {
        drag_ = Drag::move;
    } else {
        event->ignore();
    }
}

void SlicePane::mouseMoveEvent(QMouseEvent* event) {
    if (!content_) return;
    pointer_ = event->localPos();
    const QPointF drag = event->localPos() - drag_from_;
    drag_from_ = event->localPos();
    switch (drag_) {
        case Drag::crosshair:
            choose_at(event->localPos());
            break;
        case Drag::probe:
            aim_at(event->localPos());
            break;
        case Drag::window:
            change_window(drag);
            break;
        case Drag::move:
            view_.moved += drag / map().per_mm;
            picture_changed();
            break;
        case Drag::none:
            break;
    }
    update();
}

void SlicePane::mouseReleaseEvent(QMouseEvent* event) {
    const bool left = drag_ == Drag::crosshair || drag_ == Drag::probe;
    const Qt::MouseButton of_drag = left                    ? Qt::LeftButton
                                    : drag_ == Drag::window ? Qt::RightButton
                                                            : Qt::MiddleButton;
    if (event->button() == of_drag) drag_ = Drag::none;
}

void SlicePane::mouseDoubleClickEvent(QMouseEvent*) {
    if (content_) reset();
}

void SlicePane::wheelEvent(QWheelEvent* event) {
    if (!content_) return;
    event->accept();
    const int turned = event->angleDelta().y();
    if (event->modifiers() & Qt::ControlModifier) {
        zoom_at(event->position(), std::pow(1.2, turned / 120.0));
        return;
    }
    // Touch pads turn by less than a step at a time.
    if (turned * wheel_ < 0) wheel_ = 0;
    wheel_ += turned;
    const int steps = wheel_ / 120;
    wheel_ -= 120 * steps;
    if (steps == 0) return;
    if (drag_ == Drag::probe) {
        drag_layer_ = next_layer(drag_layer_, steps);
        aim_at(event->position());
    } else {
        step_slice(steps);
    }
}

void SlicePane::keyPressEvent(QKeyEvent* event) {
    if (!content_) return event->ignore();
    const auto move = [&](double u, double v) {
        const Vec3 index = index_from_physical(geometry(), crosshair_);
        Vec3 slice = slice_from_index(content_->plane, geometry(), index);
        slice[0] = std::clamp(slice[0] + u, 0.0, content_->samples.width() - 1.0);
        slice[1] = std::clamp(slice[1] + v, 0.0, content_->samples.height() - 1.0);
        choose(
            physical_from_index(geometry(), index_from_slice(content_->plane, geometry(), slice)));
    };
    const QPointF middle = QRectF(rect()).center();
    switch (event->key()) {
        case Qt::Key_Left:
            return move(-1, 0);
        case Qt::Key_Right:
            return move(1, 0);
        case Qt::Key_Up:
            return move(0, -1);
        case Qt::Key_Down:
            return move(0, 1);
        case Qt::Key_PageUp:
            return step_slice(1);
        case Qt::Key_PageDown:
            return step_slice(-1);
        case Qt::Key_Plus:
        case Qt::Key_Equal:
            return zoom_at(middle, 1.2);
        case Qt::Key_Minus:
            return zoom_at(middle, 1 / 1.2);
        case Qt::Key_Home:
            return reset();
        default:
            event->ignore();
    }
}

void SlicePane::leaveEvent(QEvent*) {
    pointer_.reset();
    update();
}

}  // namespace palpate::viewer
