// The widget: composes the layers of the scene, and tells what is seen.
#include "apps/viewer/scene/scene.hpp"

#include <vtkCamera.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <QEvent>
#include <QFontMetricsF>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "apps/viewer/model/hands.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/scene_parts.hpp"
#include "apps/viewer/scene/surface_blocks.hpp"
#include "apps/viewer/scene/view_space.hpp"
#include "pictures/vtk/shapes.hpp"

namespace palpate::viewer {
namespace {

bool is_dark(const QPalette& palette) {
    return palette.color(QPalette::Window).lightnessF() < 0.5;
}
Colour background_of(const QPalette& palette) {
    if (is_dark(palette)) return {0.13, 0.135, 0.145};
    return {0.945, 0.953, 0.961};  // the paper of our pictures
}
Colour ink_of(const QPalette& palette) {
    return is_dark(palette) ? Colour{0.78, 0.79, 0.8} : Colour{0.3, 0.3, 0.3};
}

constexpr int apart_px = 12;  // points of what is seen

/// On an edge of the box that may be drawn round the field.
bool is_on_outline(const Field& field, const Vec3& point, double near_mm) {
    const Geometry& geometry = field.geometry();
    const int beyond = closing_samples(field.interpolation());
    const Vec3 index = index_from_physical(geometry, point);
    int ends = 0;
    for (int a = 0; a < 3; ++a) {
        const double near = near_mm / geometry.spacing[a];
        const double last = geometry.size[a] - 1 + beyond;
        ends += std::abs(index[a] + beyond) < near || std::abs(index[a] - last) < near;
    }
    return ends >= 2;
}

}  // namespace

Scene::Scene(QWidget* parent, MakePainter make_painter)
    : QVTKOpenGLNativeWidget(parent),
      parts_(std::make_unique<Parts>(std::move(make_painter))),
      refresh_(this) {
    setObjectName("scene");
    setAccessibleName(tr("3-D view"));
    setFocusPolicy(Qt::StrongFocus);
    setMinimumSize(120, 90);
    setMouseTracking(true);
    setRenderWindow(parts_->window.Get());
    const Colour paper = background_of(palette());
    parts_->front->SetBackground(paper.red, paper.green, paper.blue);  // until there is a picture
    // The widget handles mouse and keys itself.
    if (auto* const interactor = parts_->window->GetInteractor()) {
        interactor->SetInteractorStyle(nullptr);
    }
    refresh_.setSingleShot(true);
    connect(&refresh_, &QTimer::timeout, this, [this] {
        if (!parts_->outdated || !isVisible()) return;
        lay_out();
        parts_->window->Render();  // calls update() in the end
    });
    connect(&parts_->background, &BackgroundRenderer::painted, this, &Scene::refresh);
    connect(&parts_->background, &BackgroundRenderer::surface_ready, this, &Scene::surface_ready);
    connect(&parts_->background, &BackgroundRenderer::problem, this, &Scene::problem);
}

Scene::~Scene() {
    // VTK gives its textures back while the context is there.
    makeCurrent();
    parts_->window->Finalize();
    doneCurrent();
}

ViewSize Scene::view_size() const {
    return {double(std::max(1, width())), double(std::max(1, height()))};
}

void Scene::set_field(const Field& field, double isovalue) {
    const auto& before = parts_->background.field();
    parts_->shown = with_field(parts_->shown, before ? &*before : nullptr, field, isovalue);
    parts_->forget_hands();
    parts_->patch_detail.reset();
    parts_->patched_level = std::nan("");
    parts_->background.set_field(field, isovalue);
    reset_camera();
    changed();
}

void Scene::update_field(const Field& field) {
    parts_->background.update_field(field);
    // The lattice around a proxy is that of the new version.
    if (std::ranges::any_of(parts_->hands, [](const auto& h) { return h.snapshot.has_value(); })) {
        refresh();
    }
}

void Scene::clear() {
    parts_->forget_hands();
    parts_->patch_detail.reset();
    parts_->background.clear();
    refresh();
    changed();
}

const Shown& Scene::shown() const {
    return parts_->shown;
}

void Scene::set_shown(const Shown& shown) {
    if (!shown.look.slices) parts_->shown.crosshair = shown.crosshair;  // it is not seen
    if (shown == parts_->shown) return;
    for (int hand = 1; hand <= most_hands; ++hand) {
        const auto& tool = shown.tools[hand];
        if (tool == parts_->hands[hand].tool) continue;
        parts_->hands[hand].tool = tool;
        parts_->hands[hand].tool_shape = tool ? shape_of(*tool) : nullptr;
    }
    parts_->shown = shown;
    parts_->look = scene_look(shown.look, shown.layers);
    parts_->background.set_most_triangles(shown.most_triangles);
    parts_->background.set_isovalue(shown.isovalue);
    setCursor(shown.measuring || shown.probe ? Qt::CrossCursor : Qt::ArrowCursor);
    refresh();
    changed();
}

void Scene::show_snapshot(const std::optional<Snapshot>& snapshot, int hand) {
    std::optional<Snapshot>& shown = parts_->hands[hand].snapshot;
    if (!snapshot && !shown) return;
    constexpr double unseen_px = 0.1;
    if (snapshot && shown &&
        looks_same(*snapshot, *shown, unseen_px * mm_per_pixel(camera_, view_size()))) {
        return;
    }
    shown = snapshot;
    refresh();
}

void Scene::set_overlay(std::vector<DrawnSurface> surfaces) {
    parts_->background.set_overlay(std::move(surfaces));
}

void Scene::set_camera(const pictures::Camera& camera) {
    const bool finite = camera.focus.allFinite() && camera.towards_viewer.allFinite() &&
                        camera.up.allFinite() && std::isfinite(camera.half_height);
    if (!finite || !(camera.half_height > 0) ||
        !(camera.up.cross(camera.towards_viewer).norm() > 0)) {
        throw std::invalid_argument("a camera needs two directions and a height above 0");
    }
    move_camera(camera);
}

void Scene::move_camera(const pictures::Camera& camera) {
    fitted_ = false;
    camera_ = camera;
    changed();
}

void Scene::look_from(const pictures::View& view) {
    pictures::Camera camera = camera_;
    camera.towards_viewer = view.towards_viewer;
    camera.up = view.up;
    const bool fitted = fitted_;
    set_camera(camera);
    if (fitted) show_whole();
}

void Scene::reset_camera() {
    if (!parts_->background.field()) return;
    const Geometry& geometry = parts_->background.field()->geometry();
    move_camera(whole(geometry, pictures::natural_view(geometry, Vec3::Zero()), view_size()));
    fitted_ = true;
}

void Scene::show_whole() {
    if (!parts_->background.field()) return;
    const pictures::View view{camera_.towards_viewer, camera_.up};
    move_camera(whole(parts_->background.field()->geometry(), view, view_size()));
    fitted_ = true;
}

void Scene::changed() {
    RenderRequest request;
    request.look = parts_->look;
    request.crosshair = parts_->shown.crosshair;
    request.background = background_of(palette());
    request.ink = ink_of(palette());
    request.camera = camera_;
    constexpr double glass = 0.25;
    if (parts_->shown.pressed) {
        request.look.surface_opacity = std::min(request.look.surface_opacity, glass);
    }
    request.pixel_ratio = devicePixelRatioF();
    if (isVisible()) {
        request.width = static_cast<int>(std::lround(width() * request.pixel_ratio));
        request.height = static_cast<int>(std::lround(height() * request.pixel_ratio));
    } else {
        request.width = request.height = 0;
    }
    parts_->background.request(request);  // shown once it is painted
}

bool Scene::settled() const {
    return parts_->background.settled() && !parts_->outdated;
}

double Scene::frame_seconds() const {
    return parts_->background.frame_seconds();
}

bool Scene::on_hardware() const {
    return parts_->background.shown() && parts_->background.shown()->hardware;
}

QImage Scene::picture() {
    return grabFramebuffer();
}

/// Once the events that are there already have been dealt with.
void Scene::refresh() {
    parts_->outdated = true;
    refresh_.start(0);
}

/// Shows a piece of the surface at a hand that presses through. It stays until the proxy has moved
/// by a part of a voxel.
void Scene::show_patch(const Field& field) {
    for (SeenHand& hand : parts_->hands) hand.patch = nullptr;
    const std::optional<double>& pressed = parts_->shown.pressed;
    SeenHand& hand = parts_->hands[parts_->shown.pressing];
    if (!pressed || !parts_->look.surface || !is_seen(hand)) return;
    const Vec3& scp = hand.snapshot->session.tick.proxy.scp;
    const double unmoved = 0.5 * field.geometry().spacing.minCoeff();
    if (!((scp - parts_->patched).norm() < unmoved) || parts_->patched_level != *pressed) {
        const auto patch = parts_->patch = local_patch(field, scp, *pressed);
        parts_->patch_shape =
            patch ? pictures::mesh_of(patch->positions, patch->normals, patch->triangles) : nullptr;
        parts_->patched = scp;
        parts_->patched_level = *pressed;
    }
    hand.patch = parts_->patch_shape;
    hand.patch_memory = parts_->patch;
}

void Scene::lay_out() {
    const auto& shown = parts_->background.shown();
    const auto& field = parts_->background.field();
    const Look& look = parts_->look;
    const double ratio = devicePixelRatioF();
    Annotations::Content written;
    // The camera of the image shown: while that lags, the probe stays in place on the surface.
    written.camera = shown ? shown->camera : camera_;
    written.size = view_size();
    written.ratio = ratio;
    written.em = ratio * QFontMetricsF(font()).ascent();
    written.ink = ink_of(palette());
    written.paper = background_of(palette());
    parts_->front->SetBackground(written.paper.red, written.paper.green, written.paper.blue);
    shown ? parts_->solid->set_layer(shown, shown->solid, false) : parts_->solid->clear();
    shown ? parts_->glass->set_layer(shown, shown->glass, true) : parts_->glass->clear();
    std::vector<Mark> marks;
    if (field) {
        const Geometry& geometry = field->geometry();
        const MarkView view{physical_centre(geometry), mm_per_pixel(written.camera, written.size),
                            ratio};
        direct(*parts_->front->GetActiveCamera(), written.camera, view.origin, reach_of(geometry));
        show_patch(*field);
        for (int hand = 1; hand <= most_hands; ++hand) {
            SeenHand& seen = parts_->hands[hand];
            seen.brush = parts_->shown.brush;
            if (!is_seen(seen)) continue;
            add_hand(marks, seen, look, finest_at_proxy(hand, *field), view, written.ink,
                     parts_->shapes);
        }
        add_cut(marks, look, geometry, view, held_, parts_->shapes.ball);
        add_measurements(marks, parts_->shown.measurements, view);
        written.measurements = parts_->shown.measurements;
        written.unit = parts_->shown.unit;
        written.orientation = look.orientation;
        written.oriented = geometry.oriented;
        written.scale_bar = look.scale_bar && geometry.measured;
    }
    parts_->marks->show(marks);
    parts_->faint_marks->show(marks);
    parts_->annotations.show(written);
    parts_->outdated = false;
}

void Scene::resizeEvent(QResizeEvent* event) {
    QVTKOpenGLNativeWidget::resizeEvent(event);
    if (fitted_ && parts_->background.field()) {
        show_whole();
    } else {
        changed();
    }
}

void Scene::showEvent(QShowEvent* event) {
    QVTKOpenGLNativeWidget::showEvent(event);
    changed();
}

void Scene::changeEvent(QEvent* event) {
    QVTKOpenGLNativeWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange) changed();
}

void Scene::set_patch(const std::optional<ScenePatch>& patch) {
    if (!parts_->background.field()) return;
    parts_->patch_detail = patch ? patch->detail : nullptr;
    parts_->background.set_patch(patch);
    refresh();  // tetrahedra and patches at the proxy are those of the finer data
}

bool Scene::shows_whole() const {
    return parts_->background.shows_whole();
}

const Field& Scene::finest_at_proxy(int hand, const Field& field) const {
    const auto& snapshot = parts_->hands[hand].snapshot;
    if (!parts_->patch_detail || !snapshot) return field;
    constexpr double border = 3;  // [voxel] of other samples
    const Field& finer = parts_->patch_detail->field;
    const Vec3 index = index_from_physical(finer.geometry(), snapshot->session.tick.proxy.scp);
    const Vec3 last = finer.geometry().size.cast<double>().array() - 1 - border;
    const bool inside = (index.array() >= border).all() && (index.array() <= last.array()).all();
    return inside ? finer : field;
}

bool Scene::is_in_view(const Vec3& point) const {
    const Pixel at = pixel_of(camera_, view_size(), point);
    return at.x >= 0 && at.y >= 0 && at.x < width() && at.y < height();
}

std::optional<SeenPoints> Scene::seen_points() const {
    const auto& field = parts_->background.field();
    if (!field || !isVisible()) return std::nullopt;
    SeenPoints seen;
    const double pixel = mm_per_pixel(camera_, view_size());
    seen.half_height = camera_.half_height;
    seen.pixel_mm = pixel / devicePixelRatioF();
    double nearest = HUGE_VAL;
    for (int y = apart_px / 2; y < height(); y += apart_px) {
        for (int x = apart_px / 2; x < width(); x += apart_px) {
            const auto at = surface_at({double(x), double(y)});
            if (!at || is_on_outline(*field, *at, 2 * pixel)) continue;
            seen.points.push_back(*at);
            const double away = std::hypot(x - 0.5 * width(), y - 0.5 * height());
            if (away < nearest) {
                nearest = away;
                seen.middle = *at;
            }
        }
    }
    return seen;
}

}  // namespace palpate::viewer
