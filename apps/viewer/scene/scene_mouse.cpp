// The widget's input: moves camera, probe and cut by mouse, and finds points on what is seen.
#include <QApplication>
#include <QMouseEvent>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>

#include "apps/viewer/scene/scene_parts.hpp"
#include "apps/viewer/scene/view_space.hpp"

namespace palpate::viewer {
namespace {

constexpr double finer = 0.2;        // of the distance dragged, with Shift held
constexpr double notch_zoom = 1.15;  // a notch of the wheel
constexpr double zoom_px = 150;      // dragged so far the scale doubles or halves

}  // namespace

Scene::Drag Scene::drag_of(const QMouseEvent& event) const {
    const bool probe = parts_->shown.probe;
    const Qt::KeyboardModifiers keys = event.modifiers();
    switch (event.button()) {
        case Qt::LeftButton:
            if (probe && keys & Qt::ControlModifier) return Drag::tool;
            if (probe) return keys & Qt::AltModifier ? Drag::turn : Drag::probe;
            return keys & Qt::ShiftModifier ? Drag::pan : Drag::turn;
        case Qt::MiddleButton:
            return Drag::pan;
        case Qt::RightButton:
            return probe ? Drag::turn : Drag::zoom;
        default:
            return Drag::none;
    }
}

/// The handle of the cut that is near the pointer.
std::optional<std::size_t> Scene::handle_at(const QPointF& at) const {
    constexpr double reach_px = 10;
    const auto& field = parts_->background.field();
    if (!field) return std::nullopt;
    const double arm = cut_arm_px * mm_per_pixel(camera_, view_size());
    const auto handles = handles_of(parts_->look, field->geometry(), arm);
    std::optional<std::size_t> nearest;
    double least = reach_px;
    for (std::size_t i = 0; i < handles.size(); ++i) {
        const Pixel seen = pixel_of(camera_, view_size(), handles[i].at);
        const double away = std::hypot(seen.x - at.x(), seen.y - at.y());
        if (away >= least) continue;
        least = away;
        nearest = i;
    }
    return nearest;
}

void Scene::show_held(std::optional<std::size_t> handle) {
    if (handle == held_) return;
    held_ = handle;
    refresh();
}

void Scene::hold_handle() {
    const Geometry& geometry = parts_->background.field()->geometry();
    const double arm = cut_arm_px * mm_per_pixel(camera_, view_size());
    held_from_ = handles_of(parts_->look, geometry, arm).at(held_.value());
    held_to_ = held_from_.at;
    drag_ = Drag::handle;
}

/// Along its line as far as the pointer went along what is seen of that; freely in the view plane.
void Scene::move_handle(const QPointF& by) {
    const Geometry& geometry = parts_->background.field()->geometry();
    const ViewSize size = view_size();
    const double mm = mm_per_pixel(camera_, size);
    const auto [at, along] = held_from_;
    if (along.norm() == 0) {
        held_to_ += in_view_plane(camera_, size, by.x(), by.y());
    } else {
        constexpr double end_on = 0.1;  // a line that points at the viewer moves with up and down
        const Pixel from = pixel_of(camera_, size, at), tip = pixel_of(camera_, size, at + along);
        const QPointF seen(mm * (tip.x - from.x), mm * (tip.y - from.y));
        const double length = QPointF::dotProduct(seen, seen);
        const double moved =
            length > end_on * end_on ? QPointF::dotProduct(seen, by) / length : -by.y();
        held_to_ += mm * moved * along;
    }
    const Look look = with_handle_at(parts_->shown.look, geometry, held_.value(), held_to_);
    set(*this, &Shown::look, look);
    Q_EMIT cut_moved(look);
}

void Scene::mousePressEvent(QMouseEvent* event) {
    if (drag_ != Drag::none) return;  // one button after the other
    drag_ = drag_of(*event);
    drag_from_ = drag_start_ = event->localPos();
    event->accept();
    if (parts_->shown.measuring && event->button() == Qt::LeftButton) {
        drag_ = Drag::none;
        if (const auto at = surface_at(drag_from_)) Q_EMIT point_chosen(*at);
        return;
    }
    if (event->button() == Qt::LeftButton) {
        show_held(handle_at(drag_from_));
        if (held_) hold_handle();
    }
    clicks_ = drag_ == Drag::probe && !(event->modifiers() & Qt::ShiftModifier);
    if (clicks_ && parts_->background.field()) {
        Q_EMIT probe_pressed(point_at(camera_, view_size(), {drag_from_.x(), drag_from_.y()}));
    }
}

void Scene::mouseMoveEvent(QMouseEvent* event) {
    // A hand that trembles clicks all the same. A drag then catches up with the pointer.
    const double way = (event->localPos() - drag_start_).manhattanLength();
    if (drag_ == Drag::probe && clicks_ && way < QApplication::startDragDistance()) return;
    clicks_ = false;
    const QPointF by = event->localPos() - drag_from_;
    drag_from_ = event->localPos();
    if (by.isNull() || !parts_->background.field()) return;
    if (drag_ == Drag::none) show_held(handle_at(drag_from_));
    if (drag_ == Drag::none && parts_->shown.measuring) {
        if (const auto at = surface_at(drag_from_)) Q_EMIT point_pointed_at(*at);
    }
    const ViewSize size = view_size();
    switch (drag_) {
        case Drag::turn:
            move_camera(turned(camera_, size, by.x(), by.y()));
            break;
        case Drag::pan:
            move_camera(panned(camera_, size, by.x(), by.y()));
            break;
        case Drag::zoom:
            move_camera(zoomed(camera_, size, std::exp2(-by.y() / zoom_px),
                               {drag_start_.x(), drag_start_.y()}));
            break;
        case Drag::probe: {
            const double part = event->modifiers() & Qt::ShiftModifier ? finer : 1;
            Q_EMIT probe_dragged(part * in_view_plane(camera_, size, by.x(), by.y()));
            break;
        }
        case Drag::tool: {
            const double part = event->modifiers() & Qt::ShiftModifier ? finer : 1;
            Q_EMIT tool_turned(part * rotation_of_drag(camera_, size, by.x(), by.y()));
            break;
        }
        case Drag::handle:
            if (held_) move_handle(by);
            break;
        case Drag::none:
            break;
    }
}

void Scene::mouseReleaseEvent(QMouseEvent* event) {
    if (drag_ == Drag::probe && event->button() == Qt::LeftButton) Q_EMIT probe_released();
    if (event->buttons() == Qt::NoButton) drag_ = Drag::none;
}

/// By the depths of what is shown; nothing beside everything.
std::optional<Vec3> Scene::surface_at(const QPointF& pixel) const {
    const auto& shown = parts_->background.shown();
    const auto& field = parts_->background.field();
    if (!shown || !field) return std::nullopt;
    const double scale = double(shown->height) / height();  // as LayerProp draws it
    const auto x = static_cast<int>(0.5 * shown->width + scale * (pixel.x() - 0.5 * width()));
    const int y = shown->height - 1 - static_cast<int>(pixel.y() * scale);
    if (x < 0 || y < 0 || x >= shown->width || y >= shown->height) return std::nullopt;
    const auto depth_at = [&](const pictures::Layer& layer) {
        const std::size_t i = std::size_t(y) * std::size_t(shown->width) + std::size_t(x);
        return i < layer.depth.size() ? layer.depth[i] : 1.0F;
    };
    const float depth = std::min(depth_at(shown->solid), depth_at(shown->glass));
    if (depth >= 1) return std::nullopt;
    const Vec3 at = point_at(shown->camera, view_size(), {pixel.x(), pixel.y()});
    const Vec3 towards = axes_of(shown->camera).towards_viewer;
    const Vec3 origin = physical_centre(field->geometry());
    return at + (height_of(depth, shown->reach) - towards.dot(at - origin)) * towards;
}

void Scene::mouseDoubleClickEvent(QMouseEvent* event) {
    const bool asked = event->button() == Qt::LeftButton && event->modifiers() & Qt::ShiftModifier;
    const auto at = surface_at(event->localPos());
    if (!asked || !at) {
        if (!asked) mousePressEvent(event);
        return;
    }
    pictures::Camera camera = camera_;
    camera.focus = *at;
    move_camera(camera);
}

void Scene::wheelEvent(QWheelEvent* event) {
    const double notches = event->angleDelta().y() / 120.0;
    event->accept();
    if (notches == 0 || !parts_->background.field()) return;
    const ViewSize size = view_size();
    if (parts_->shown.probe && !(event->modifiers() & Qt::ControlModifier)) {
        const double part = event->modifiers() & Qt::ShiftModifier ? finer : 1;
        const double into = part * notches * parts_->shown.wheel_px * mm_per_pixel(camera_, size);
        Q_EMIT probe_dragged(-into * axes_of(camera_).towards_viewer);
        return;
    }
    const QPointF at = event->position();
    move_camera(zoomed(camera_, size, std::pow(notch_zoom, notches), {at.x(), at.y()}));
}

}  // namespace palpate::viewer
