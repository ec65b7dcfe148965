// Keeps scene and slices at the snapshot, the data and the level that are felt or played.
#include "apps/viewer/window/display_controller.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>

#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/look_controls.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/scene.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/measure_controller.hpp"
#include "apps/viewer/window/overlay_controller.hpp"
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

DisplayController::DisplayController(const Desk& desk, MeasureController& measuring,
                                     OverlayController& overlays)
    : Controller(desk), measuring_(measuring), overlays_(overlays) {
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
    connect(&panel_.look_controls(), &LookControls::look_changed, this,
            &DisplayController::show_look);
    connect(&panel_.look_controls(), &LookControls::cut_wanted, this, &DisplayController::set_cut);
    connect(&views_.scene(), &Scene::cut_moved, &panel_.look_controls(), &LookControls::set_look);
}

void DisplayController::clear() {
    held_.reset();
    isovalue_.reset();
    shown_.reset();
    layers_.reset();
    overlays_.set_layers(nullptr);
    next_level_.reset();
    views_.clear();
}

void DisplayController::show_field(const Field& field, double isovalue) {
    isovalue_ = isovalue;
    shown_.reset();
    const auto& streamed = content_.volume()->loaded.streamed;
    std::optional<Geometry> counted;  // a store's level that is felt
    if (streamed) counted = run::start_samples(content_.volume()->loaded)->geometry();
    views_.set_field(field, isovalue, counted);
}

void DisplayController::show_volume(const Field& field, double isovalue,
                                    const DeviceTransform& transform) {
    show_field(field, isovalue);
    views_.scene().reset_camera();
    look_from_hand(transform);
    // With another device the view is that of the hand, or it would go aslant.
    const bool mouse = content_.live() && content_.live()->mouse();
    if (const auto view = face_on(field.geometry(), mouse ? 0.3 : 0)) {
        views_.scene().look_from(*view);
    }
    views_.set_window(content_.volume()->dark(), content_.volume()->bright());
}

HandSnapshots DisplayController::observe() {
    const HandSnapshots all = held_ ? *held_ : content_.snapshots();
    for (int hand = 1; hand <= content_.hands(); ++hand) {
        views_.scene().set_tool(content_.tool(hand), hand);
    }
    views_.show_snapshots(all, content_.hand());
    if (const auto& now = all[content_.hand()]) {
        observe_data(*now);
        observe_layers();
        observe_level(*now);
    }
    return all;
}

/// Their surfaces are seen with the look.
void DisplayController::observe_layers() {
    const SharedLayers layers = content_.layers();
    if (layers == layers_) return;
    layers_ = layers;
    overlays_.set_layers(layers);
    show_look();
}

void DisplayController::show_look() {
    views_.set_look(panel_.look_controls().look(), layers_);
}

/// The scene's surface is the outermost; the slices tell which one the hand meets next.
void DisplayController::observe_layer_level(const Snapshot& now) {
    const double outer = layers_->layers.front().level;
    if (isovalue_ != outer) {
        isovalue_ = outer;
        views_.set_isovalue(outer);
    }
    const double next = now.session.tick.proxy.isovalue;
    if (std::isfinite(next)) next_level_ = next;
    views_.set_next_level(next_level_.value_or(outer));
}

/// While the hand presses through one surface to the next, the first one stays.
void DisplayController::observe_level(const Snapshot& now) {
    if (levels_in(layers_) > 0) return observe_layer_level(now);
    // The overlay shows labels; no level of the densities is felt.
    if (have_surfaces(layers_)) return views_.set_next_level(infinity);
    next_level_.reset();
    const ProxyUpdate& proxy = now.session.tick.proxy;
    const bool pressing = now.penetrability_on && proxy.mode == Mode::constrained && isovalue_ &&
                          proxy.isovalue != *isovalue_;
    if (std::isfinite(proxy.isovalue) && !pressing && isovalue_ != proxy.isovalue) {
        isovalue_ = proxy.isovalue;
        views_.set_isovalue(proxy.isovalue);
    }
    views_.set_pressed(
        pressing && std::isfinite(proxy.isovalue) ? std::optional(proxy.isovalue) : std::nullopt,
        content_.hand());
}

void DisplayController::observe_data(const Snapshot& now) {
    const Field field = content_.seen(content_.felt_at(now));
    if (shown_ && same_samples(*shown_, field)) return;
    shown_ = field;
    views_.update_field(field);
}

void DisplayController::hold() {
    if (content_.live()) held_ = content_.snapshots();
}

void DisplayController::set_look(const Look& look) {
    panel_.look_controls().set_look(look);
    show_look();
}

void DisplayController::set_cut(Cut cut) {
    const Vec3 towards = views_.scene().camera().towards_viewer;
    set_look(with_cut(panel_.look_controls().look(), cut, views_.crosshair(), towards));
}

void DisplayController::use_usual_look() {
    const Opened& opened = *content_.volume();
    const Volume& volume = opened.loaded.volume;
    Look look = panel_.look_controls().look();
    look.transfer = preset(suggested_preset(opened.histogram, volume), opened.histogram, volume);
    // Of the volume before.
    look.surfaces.clear();
    look.cut = Cut::nothing;
    look.overlay = {};
    set_look(look);
}

void DisplayController::look_from_hand(const DeviceTransform& transform) {
    views_.scene().look_from({transform.rotation.col(2), transform.rotation.col(1)});
}

void DisplayController::save_view(SessionFile& session) const {
    session.look = panel_.look_controls().look();
    session.camera = views_.scene().camera();
    session.crosshair = views_.crosshair();
    session.follow = views_.follows();
    session.window_low = views_.window_low();
    session.window_high = views_.window_high();
    session.slices_shown = views_.slices_shown();
    session.measurements = measuring_.measurements();
    if (overlays_.overlay()) session.overlay = overlays_.overlay()->source;
}

void DisplayController::restore_view(const SessionFile& session) {
    Look look = session.look;
    if (look.transfer.points.empty()) look.transfer = panel_.look_controls().look().transfer;
    set_look(look);
    if (session.window_low < session.window_high) {
        views_.set_window(session.window_low, session.window_high);
    }
    if (session.crosshair) views_.set_crosshair(*session.crosshair);
    views_.set_follow(session.follow);
    views_.show_slices(session.slices_shown);
    measuring_.set_measurements(session.measurements);
    if (session.overlay) overlays_.open(*session.overlay);
    if (session.camera) views_.scene().set_camera(*session.camera);
}

}  // namespace palpate::viewer
