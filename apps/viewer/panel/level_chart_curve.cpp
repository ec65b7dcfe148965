// The curve on the level chart: its knots by mouse and by keys.
#include <QMouseEvent>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/level_chart.hpp"

namespace palpate::viewer {
namespace {

constexpr double knot_reach = 5;  // [logical pixels] as of everything on the chart

}  // namespace

void LevelChart::set_curve(const Knots& knots, double least, const QString& unit) {
    if (drag_ == Drag::knot) return;
    if (held_knot_ >= static_cast<int>(knots.size())) held_knot_ = -1;
    curve_ = line_of(knots, least, unit);
    update();
}

/// Another knot of the curve.
void LevelChart::mouseDoubleClickEvent(QMouseEvent* event) {
    const QPointF at = event->localPos();
    if (curve_.knots.empty() || event->button() != Qt::LeftButton || !plot().contains(at) ||
        curve_.knot_at(at, axis(), plot(), knot_reach) >= 0) {
        return mousePressEvent(event);
    }
    held_knot_ = curve_.add(curve_.knot_of(at, axis(), plot()));
    if (held_knot_ < 0) return;
    update();
    Q_EMIT curve_changed(curve_.knots);
}

/// The last one stays: a curve without knots says nothing.
void LevelChart::remove_knot(int knot) {
    if (knot < 0 || curve_.knots.size() < 2) return;
    curve_.knots.erase(curve_.knots.begin() + knot);
    held_knot_ = -1;
    update();
    Q_EMIT curve_changed(curve_.knots);
}

/// Moves the held knot, or holds another. False: the key is for something else.
bool LevelChart::step_knot(int key, double steps) {
    const int count = static_cast<int>(curve_.knots.size());
    if (count == 0) return false;
    const bool chooses = key == Qt::Key_PageDown || key == Qt::Key_PageUp;
    if (chooses || held_knot_ < 0) {
        const bool known = chooses || key == Qt::Key_Left || key == Qt::Key_Right ||
                           key == Qt::Key_Up || key == Qt::Key_Down;
        if (!known) return false;
        const int next = held_knot_ + (key == Qt::Key_PageUp ? -1 : 1);
        held_knot_ = held_knot_ < 0 ? 0 : std::clamp(next, 0, count - 1);
        update();
        return true;
    }
    const auto held = static_cast<std::size_t>(held_knot_);
    QPointF at = curve_.place_of(curve_.knots[held], axis(), plot());
    const double pixels = steps;  // the finest that dragging has
    switch (key) {
        case Qt::Key_Left:
            at.rx() -= pixels;
            break;
        case Qt::Key_Right:
            at.rx() += pixels;
            break;
        case Qt::Key_Up:
            at.ry() -= pixels;
            break;
        case Qt::Key_Down:
            at.ry() += pixels;
            break;
        case Qt::Key_Insert: {
            // In the middle to the next one, or to the edge.
            const double right = held + 1 < curve_.knots.size()
                                     ? axis().x_of(curve_.knots[held + 1].at)
                                     : plot().right();
            at.rx() = 0.5 * (at.x() + right);
            const int added = curve_.add(curve_.knot_of(at, axis(), plot()));
            if (added < 0) return true;
            held_knot_ = added;
            break;
        }
        default:
            return false;
    }
    if (key != Qt::Key_Insert) curve_.move(held, at, axis(), plot());
    update();
    Q_EMIT curve_changed(curve_.knots);
    return true;
}

}  // namespace palpate::viewer
