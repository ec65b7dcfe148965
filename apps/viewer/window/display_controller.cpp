// Keeps scene and slices at the snapshot, the data and the level that are felt or played.
#include "apps/viewer/window/display_controller.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/look_controls.hpp"
#include "apps/viewer/window/measure_controller.hpp"
#include "apps/viewer/window/overlay_controls.hpp"
#include "apps/viewer/window/panel.hpp"
#include "apps/viewer/window/views.hpp"

namespace palpate::viewer {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Of a stack thinner than this part of its next longer side, as it lies on a screen: rows to the
/// right, and down or towards the head. 0: of a single slice.
std::optional<pictures::View> face_on(const Geometry& geometry, double is_thin) {
    int thin = 0;
    Vec3 sides = (geometry.size.cast<double>() - Vec3::Ones()).cwiseProduct(geometry.spacing);
    const double thickness = sides.minCoeff(&thin);
    sides[thin] = sides.maxCoeff();
    if (thickness > is_thin * sides.minCoeff()) return std::nullopt;
    const Vec3 right = geometry.direction.col(thin == 0 ? 1 : 0);
    const Vec3 up = thin == 2 ? Vec3(-geometry.direction.col(1)) : geometry.direction.col(2);
    return pictures::View{right.cross(up), up};
}

}  // namespace

DisplayController::DisplayController(const Desk& desk, Panel& panel, MeasureController& measuring)
    : Controller(desk),
      look_(panel.look_controls()),
      overlays_(panel.overlay_controls()),
      measuring_(measuring) {
    connect(&content_, &Content::closed, this, &DisplayController::clear);
    connect(&content_, &Content::run_started, this, [this] {
        const run::Run& live = *content_.live();
        show_volume(content_.seen(content_.felt()), live.isovalue(), live.settings().transform);
    });
    connect(&content_, &Content::field_replaced, this,
            [this] { show_field(content_.seen(content_.felt()), content_.live()->isovalue()); });
    connect(&content_, &Content::playback_started, this, [this] {
        const io::RecordingHead& head = content_.playback()->head();
        show_volume(content_.seen(content_.felt()), head.isovalue, head.settings.transform);
    });
}

void DisplayController::clear() {
    held_.reset();
    views_.clear();
    set(views_, &Shown::layers, nullptr);
}

void DisplayController::show_field(const Field& field, double isovalue) {
    const auto& streamed = content_.volume()->loaded.streamed;
    std::optional<Geometry> counted;  // a store's level that is felt
    if (streamed) counted = run::start_samples(content_.volume()->loaded)->geometry();
    views_.set_field(field, isovalue, counted);
}

void DisplayController::show_volume(const Field& field, double isovalue,
                                    const DeviceTransform& transform) {
    show_field(field, isovalue);
    views_.scene().reset_camera();
    look_from(transform);
    // With another device the view is that of the hand, or it would go aslant.
    const bool mouse = content_.live() && content_.live()->mouse();
    // Microscopes do not tell the sides of a body, from one of which it would be seen otherwise.
    const double is_thin = field.geometry().oriented ? 0.3 : 0.6;
    if (const auto view = face_on(field.geometry(), mouse ? is_thin : 0)) {
        views_.scene().look_from(*view);
    }
    const Opened& opened = *content_.volume();
    set(views_, &Shown::usual_window, {opened.dark(), opened.bright()});
}

HandSnapshots DisplayController::observe() {
    const HandSnapshots all = held_ ? *held_ : content_.snapshots();
    observe_state(all[content_.hand()]);
    views_.show_snapshots(all, content_.hand());
    if (const auto& now = all[content_.hand()]) {
        views_.update_field(content_.seen(content_.felt_at(*now)));
    }
    return all;
}

namespace {

/// With layers the scene's surface is the outermost; the slices tell which one the hand meets next.
void show_level_of_layers(Shown& shown, const ProxyUpdate& proxy) {
    shown.isovalue = shown.layers->layers.front().level;
    if (std::isfinite(proxy.isovalue)) shown.next_level = proxy.isovalue;
    if (!shown.next_level) shown.next_level = shown.isovalue;
}

/// While the hand presses through one surface to the next, the first one stays.
void show_level(Shown& shown, const ProxyUpdate& proxy, bool penetrability_on) {
    shown.next_level.reset();
    if (!std::isfinite(proxy.isovalue)) return;
    const bool pressing =
        penetrability_on && proxy.mode == Mode::constrained && proxy.isovalue != shown.isovalue;
    if (pressing) shown.pressed = proxy.isovalue;
    if (!pressing) shown.isovalue = proxy.isovalue;
}

}  // namespace

void DisplayController::observe_state(const std::optional<Snapshot>& now) {
    Shown next = views_.shown();
    for (int hand = 1; hand <= content_.hands(); ++hand) next.tools[hand] = content_.tool(hand);
    if (!now) return views_.set_shown(next);
    const ProxyUpdate& proxy = now->session.tick.proxy;
    const SharedLayers before = std::exchange(next.layers, content_.layers());
    next.pressed.reset();
    next.pressing = content_.hand();
    if (levels_in(next.layers) > 0) {
        show_level_of_layers(next, proxy);
    } else if (have_surfaces(next.layers)) {
        next.next_level = infinity;  // the overlay shows labels; no level of the densities is felt
    } else {
        show_level(next, proxy, now->penetrability_on);
    }
    views_.set_shown(next);
    if (next.layers != before) overlays_.colour_labels();
}

void DisplayController::hold() {
    if (content_.live()) held_ = content_.snapshots();
}

void DisplayController::look_from_hand() {
    if (const auto now = content_.snapshot()) look_from(now->session.transform);
}

void DisplayController::look_from(const DeviceTransform& transform) {
    views_.scene().look_from({transform.rotation.col(2), transform.rotation.col(1)});
}

void DisplayController::save_view(SessionFile& session) const {
    session.look = look_.look();
    session.camera = views_.scene().camera();
    session.crosshair = views_.shown().crosshair;
    session.follow = views_.follows();
    session.window_low = views_.shown().window.low;
    session.window_high = views_.shown().window.high;
    session.slices_shown = views_.slices_shown();
    session.measurements = measuring_.measurements();
    if (overlays_.overlay()) session.overlay = overlays_.overlay()->source;
}

void DisplayController::restore_view(const SessionFile& session) {
    Look look = session.look;
    if (look.transfer.points.empty()) look.transfer = look_.look().transfer;
    look_.set_look(look);
    set(views_, &Shown::window, {session.window_low, session.window_high});
    if (session.crosshair) set(views_, &Shown::crosshair, *session.crosshair);
    views_.set_follow(session.follow);
    views_.show_slices(session.slices_shown);
    measuring_.set_measurements(session.measurements);
    if (session.overlay) overlays_.open(*session.overlay);
    if (session.camera) views_.scene().set_camera(*session.camera);
}

}  // namespace palpate::viewer
