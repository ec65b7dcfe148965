// The slice pane's input by mouse and keys.
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>

#include <cmath>

#include "apps/viewer/slices/slice_pane.hpp"

namespace palpate::viewer {

void SlicePane::mousePressEvent(QMouseEvent* event) {
    if (!content_ || drag_ != Drag::none) return;
    drag_from_ = event->localPos();
    if (event->button() == Qt::LeftButton && shown_.measuring) {
        Q_EMIT point_chosen(point_at(event->localPos()));
    } else if (event->button() == Qt::LeftButton) {
        if (shown_.probe && event->modifiers() & Qt::ControlModifier) {
            drag_ = Drag::probe;
            aimed_ = {map().sample(event->localPos()), layer()};
            Q_EMIT probe_aimed(physical(aimed_));
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
            drag_probe({map().sample(event->localPos()), aimed_.layer});
            break;
        case Drag::window:
            change_window(drag);
            break;
        case Drag::move:
            view_.moved += drag / map().per_mm;
            picture_changed();
            break;
        case Drag::none:
            if (shown_.measuring) Q_EMIT point_pointed_at(point_at(event->localPos()));
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

/// Two drags soon after another begin like a double click.
void SlicePane::mouseDoubleClickEvent(QMouseEvent* event) {
    const bool asked = event->button() == Qt::LeftButton && event->modifiers() & Qt::ShiftModifier;
    if (!asked) return mousePressEvent(event);
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
        drag_probe({map().sample(event->position()), next_layer(aimed_.layer, steps)});
    } else {
        step_slice(steps);
    }
}

void SlicePane::keyPressEvent(QKeyEvent* event) {
    if (!content_) return event->ignore();
    const auto move = [&](double u, double v) {
        choose(plane().physical(in_data(plane().point(shown_.crosshair) + Vec3(u, v, 0))));
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
