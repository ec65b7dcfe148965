// Turns drags, clicks and arrow keys into positions of the mouse device.
#include "apps/viewer/window/probe_controller.hpp"

#include <QAction>
#include <QApplication>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "apps/viewer/model/probe_route.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {
namespace {

/// So near to the probe a click takes hold of it where it is [pixels].
constexpr double grab_px = 14;
/// Farthest distance before or behind the clicked surface.
constexpr double grab_voxels = 3;
/// A click presses with this force, and no deeper than this [device mm].
constexpr double touch_newtons = 0.3, deepest_touch = 3;
/// In front of the surface at the start.
constexpr double off_voxels = 2;
/// [device mm] So near to a stop the hand has arrived.
constexpr double arrived_mm = 0.2;
/// A button held so long presses deeper, at this speed [device mm/s].
constexpr double hold_seconds = 0.6, press_speed = 3;

}  // namespace

ProbeController::ProbeController(const Desk& desk) : Controller(desk) {
    connect(&views_, &Views::probe_dragged, this, [this](const Vec3& by) {
        forget_press();
        move_by(by);
    });
    connect(&views_, &Views::double_clicked, this, &ProbeController::forget_press);
    connect(&views_.scene(), &Scene::tool_turned, this, &ProbeController::turn_by);
    connect(&views_, &Views::probe_aimed, this, &ProbeController::reach);
    connect(&views_.scene(), &Scene::probe_pressed, this, [this](const Vec3& at) {
        pressed_ = at;
        since_.start();
        held_ = true;
        pressed_seconds_ = 0;
    });
    connect(&views_.scene(), &Scene::probe_released, this, [this] { held_ = false; });
    connect(&content_, &Content::run_started, this, [this] {
        for (bool& hand : approaching_) hand = true;
        came_from_ = {};
    });
    connect(&content_, &Content::device_changed, this, [this] {
        set_pointing(possible());
        end_route();
        approaching_[content_.hand()] = true;
        came_from_[content_.hand()].reset();
    });
    connect(&content_, &Content::hand_changed, this, &ProbeController::take_over);
    connect(&content_, &Content::playback_started, this, [this] { set_pointing(false); });
    connect(&content_, &Content::closed, this, [this] {
        end_route();
        forget_press();
    });
    add_keys();
}

/// If the mouse is the device of the chosen hand, it moves that from where it is.
void ProbeController::take_over() {
    set(views_, &Shown::probe, possible());
    forget_press();
    drop_route();
}

bool ProbeController::possible() const {
    return content_.live() && content_.live()->mouse();
}

bool ProbeController::pointing() const {
    return views_.shown().probe;
}

bool ProbeController::travelling() const {
    return (approaching_[content_.hand()] && possible()) || pressed_ || !route_.empty();
}

void ProbeController::set_pointing(bool probe) {
    set(views_, &Shown::probe, probe && possible());
    if (!pointing()) return;
    views_.scene().setFocus();
    messages_.show_done(
        tr("Click to touch, drag to move the probe, turn the wheel to push it in; the right button "
           "turns the view"));
}

Vec3 ProbeController::towards_viewer() const {
    return axes_of(views_.scene().camera()).towards_viewer;
}

Vec3 ProbeController::aimed(const DeviceTransform& transform) const {
    return physical_from_device(transform, content_.live()->mouse()->aimed());
}

void ProbeController::aim(const DeviceTransform& transform, const Vec3& physical) {
    content_.live()->mouse()->aim(device_from_physical(transform, physical));
}

void ProbeController::move_by(const Vec3& by) {
    const auto now = possible() ? content_.snapshot() : std::nullopt;
    if (!now) return;
    approaching_[content_.hand()] = false;
    for (Vec3& stop : route_) stop += by;
    const Vec3 from = aimed(now->session.transform);
    aim(now->session.transform, from + before_far_side(from, by));
}

void ProbeController::move_to(const Vec3& to) {
    const auto now = possible() ? content_.snapshot() : std::nullopt;
    if (!now) return;
    end_route();
    aim(now->session.transform, to);
}

void ProbeController::forget_press() {
    pressed_.reset();
    held_ = false;
}

void ProbeController::end_route() {
    approaching_[content_.hand()] = false;
    drop_route();
}

void ProbeController::drop_route() {
    if (route_.empty()) return;
    route_.clear();
    Q_EMIT lifted(false);
}

/// [mm, physical] under a surface that is touched lightly.
double ProbeController::touch_depth(const DeviceTransform& transform) const {
    const double stiffness = content_.live()->settings().force.stiffness;
    return transform.scale * std::min(touch_newtons / stiffness, deepest_touch);
}

/// Back out of the volume, round it to the side `towards`, and forward.
void ProbeController::send_to(const DeviceTransform& transform, const Vec3& to,
                              const Vec3& towards) {
    route_ = route_in_front(content_.live()->field().geometry(), aimed(transform), to,
                            came_from_[content_.hand()].value_or(towards), towards);
    came_from_[content_.hand()] = towards;
    std::ranges::reverse(route_);
    behind_cut_ = false;
    aim(transform, route_.back());
    Q_EMIT lifted(true);
}

/// Turned as the hand holds it [mm, physical axes].
std::vector<Vec3> ProbeController::tool_points(const DeviceTransform& transform) const {
    std::vector<Vec3> points;
    const auto tool = content_.tool();
    if (!tool) return points;
    const Mat3 turned =
        transform.rotation * content_.live()->mouse()->turned_to().toRotationMatrix();
    for (const Vec3& point : tool->points()) points.push_back(turned * point);
    return points;
}

/// The part of a step that ends in front of the grid's far side.
Vec3 ProbeController::before_far_side(const Vec3& from, const Vec3& by) {
    const Vec3 towards = towards_viewer();
    const double deeper = -by.dot(towards);
    if (!(deeper > 0)) return by;
    const double room =
        from.dot(towards) - extent_along(content_.live()->field().geometry(), towards).back;
    if (deeper <= room) return by;
    messages_.show_done(tr("The probe is at the far side of the volume: nothing lies deeper"));
    return by + (deeper - std::max(room, 0.0)) * towards;
}

void ProbeController::touch(const Vec3& at) {
    const auto now = possible() ? content_.snapshot() : std::nullopt;
    if (!now) return;
    approaching_[content_.hand()] = false;
    const DeviceTransform& transform = now->session.transform;
    const Vec3 towards = towards_viewer(), from = aimed(transform);
    const Vec3 aside = at - from - (at - from).dot(towards) * towards;
    const double grab = grab_px * mm_per_pixel(views_.scene().camera(), views_.scene().view_size());
    const Content::OuterSurface outer = content_.outer_surface();
    const Geometry& geometry = content_.live()->field().geometry();
    const auto cuts = planes_of(views_.shown().look, geometry);
    const auto surface =
        tool_on_surface(outer.field, outer.level, at, towards, tool_points(transform), cuts);
    if (!surface && !cuts.empty()) {
        messages_.show_done(tr("Nothing can be touched here from in front of the cut"));
    }
    if (!surface) return;
    const ProxyUpdate& proxy = now->session.tick.proxy;
    const double away = std::abs((proxy.scp - *surface).dot(towards));
    const double voxel = geometry.spacing.maxCoeff(), near = grab_voxels * voxel;
    if (aside.norm() <= grab && away <= near && proxy.mode == Mode::constrained) return;
    send_to(transform, *surface - touch_depth(transform) * towards, towards);
    // Parts that are cut away would stop the proxy: it starts behind them, off the visible part.
    behind_cut_ = !cuts.empty();
    if (behind_cut_) route_.insert(route_.begin() + 1, *surface + off_voxels * voxel * towards);
}

void ProbeController::reach(const Vec3& to) {
    const auto now = possible() ? content_.snapshot() : std::nullopt;
    if (!now) return;
    approaching_[content_.hand()] = false;
    const ProxyUpdate& proxy = now->session.tick.proxy;
    const double near = grab_voxels * content_.live()->field().geometry().spacing.maxCoeff();
    if ((proxy.hip - to).norm() <= near && proxy.mode == Mode::constrained) return;
    const DeviceTransform& transform = now->session.transform;
    const Content::OuterSurface outer = content_.outer_surface();
    const auto approach =
        approach_to(outer.field, outer.level, to, towards_viewer(), tool_points(transform));
    if (!approach) return messages_.show_done(tr("The solid around this point has no outside"));
    const Vec3& towards = approach->towards;
    if (!approach->surface) return send_to(transform, to, towards);
    const double below = (*approach->surface - to).dot(towards), most = touch_depth(transform);
    if (below > most) {
        messages_.show_done(
            tr("This point is inside: the probe touches in front of it. Drag to press deeper"));
    }
    send_to(transform, *approach->surface - std::min(below, most) * towards, towards);
}

void ProbeController::observe() {
    const auto live = possible() ? content_.snapshot() : std::nullopt;
    if (!live || live->session.device.status != DeviceStatus::ready) return;
    const Snapshot& now = *live;
    if (approaching_[content_.hand()]) approach(now);
    // A press that is neither a drag nor the first of a double click is a touch.
    if (pressed_ && since_.elapsed() > QApplication::doubleClickInterval()) {
        touch(*std::exchange(pressed_, std::nullopt));
    }
    if (!route_.empty()) return travel(now);
    press_deeper(now);
}

/// The first thing after a start: the probe stands just off the first surface in view.
void ProbeController::approach(const Snapshot& now) {
    approaching_[content_.hand()] = false;
    const pictures::Camera camera = views_.scene().camera();
    const Vec3 towards = axes_of(camera).towards_viewer;
    const Field& field = content_.live()->field();
    const Content::OuterSurface outer = content_.outer_surface();
    const auto surface = surface_in_view(outer.field, outer.level, towards, camera.up);
    if (!surface) return;
    const DeviceTransform& transform = now.session.transform;
    const auto rest =
        tool_on_surface(outer.field, outer.level, *surface, towards, tool_points(transform));
    const Vec3 off = off_voxels * field.geometry().spacing.maxCoeff() * towards;
    send_to(transform, rest.value_or(*surface) + off, towards);
}

void ProbeController::travel(const Snapshot& now) {
    const Vec3 away = now.session.device.position - content_.live()->mouse()->aimed();
    const bool arrived = away.norm() <= arrived_mm;
    // In front of the volume nothing is in the way of the proxy, whatever held it. On the way
    // through what is cut away, it stays with the hand.
    if (route_.size() == 2 && (arrived || behind_cut_)) content_.effect().request(command::Lift{});
    if (!arrived) return;
    if (route_.size() == 1) return end_route();
    route_.pop_back();
    aim(now.session.transform, route_.back());
}

/// While the button is held still.
void ProbeController::press_deeper(const Snapshot& now) {
    if (!held_) return;
    const double seconds = 1e-3 * double(since_.elapsed()) - hold_seconds - pressed_seconds_;
    if (!(seconds > 0)) return;
    pressed_seconds_ += seconds;
    const Tick& tick = now.session.tick;
    if (tick.proxy.mode != Mode::constrained || (tick.force_flags & force_limited)) return;
    const double step = std::min(seconds, 0.1) * press_speed * now.session.transform.scale;
    move_by(-step * towards_viewer());
}

void ProbeController::nudge(const Vec3& screen) {
    if (!content_.live()) return;
    move_by(content_.live()->field().geometry().spacing.minCoeff() * in_view(screen));
}

/// From axes to the right, up and towards the viewer to physical ones.
Vec3 ProbeController::in_view(const Vec3& screen) const {
    const ViewAxes axes = axes_of(views_.scene().camera());
    return screen[0] * axes.right + screen[1] * axes.up + screen[2] * axes.towards_viewer;
}

void ProbeController::turn_by(const Vec3& rotation) {
    const auto now = possible() ? content_.snapshot() : std::nullopt;
    if (!now) return;
    devices::Mouse& mouse = *content_.live()->mouse();
    mouse.turn(
        palpate::turned(mouse.turned_to(), now->session.transform.rotation.transpose() * rotation));
    if (!content_.tool()) {
        messages_.show_done(tr("A point has no sides: choose a tool on the page Feel to turn it"));
    }
}

/// Only where the scene has the focus: elsewhere arrows belong to sliders, numbers and slices.
void ProbeController::add_keys() {
    const auto add = [this](const QString& text, int key, auto act) {
        auto* action = new QAction(text, &views_);
        action->setShortcut(QKeySequence(key));
        action->setShortcutContext(Qt::WidgetShortcut);
        connect(action, &QAction::triggered, this, act);
        views_.scene().addAction(action);
    };
    struct Key {
        QString text;
        int key;
        Vec3 step;
    };
    constexpr double notch = std::numbers::pi / 36;  // 5 degrees
    for (const Key& key : {Key{tr("Turn the tool to the left"), Qt::Key_Left, {0, -1, 0}},
                           {tr("Turn the tool to the right"), Qt::Key_Right, {0, 1, 0}},
                           {tr("Turn the tool up"), Qt::Key_Up, {-1, 0, 0}},
                           {tr("Turn the tool down"), Qt::Key_Down, {1, 0, 0}},
                           {tr("Turn the tool clockwise"), Qt::Key_PageDown, {0, 0, -1}},
                           {tr("Turn the tool anticlockwise"), Qt::Key_PageUp, {0, 0, 1}}}) {
        const Vec3 turn = notch * key.step;
        add(key.text, key.key + int(Qt::ControlModifier), [this, turn] { turn_by(in_view(turn)); });
    }
    for (const Key& key : {Key{tr("Nudge the probe to the left"), Qt::Key_Left, {-1, 0, 0}},
                           {tr("Nudge the probe to the right"), Qt::Key_Right, {1, 0, 0}},
                           {tr("Nudge the probe up"), Qt::Key_Up, {0, 1, 0}},
                           {tr("Nudge the probe down"), Qt::Key_Down, {0, -1, 0}},
                           {tr("Nudge the probe into the depth"), Qt::Key_PageUp, {0, 0, -1}},
                           {tr("Nudge the probe towards you"), Qt::Key_PageDown, {0, 0, 1}}}) {
        const Vec3 step = key.step, far = 10 * step;
        add(key.text, key.key, [this, step] { nudge(step); });
        add(tr("%1 by ten voxels").arg(key.text), key.key + int(Qt::ShiftModifier),
            [this, far] { nudge(far); });
    }
    views_.scene().setFocusPolicy(Qt::StrongFocus);
}

}  // namespace palpate::viewer
