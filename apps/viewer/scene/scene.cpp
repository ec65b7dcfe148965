// The widget: moves camera and probe by mouse, and composes the layers of the scene.
#include "apps/viewer/scene/scene.hpp"

#include <QFontMetricsF>
#include <QMouseEvent>
#include <QWheelEvent>

#include <vtkCamera.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkTimerLog.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/viewer/model/hand_state.hpp"
#include "apps/viewer/scene/annotations.hpp"
#include "apps/viewer/scene/background_renderer.hpp"
#include "apps/viewer/scene/cut_handles.hpp"
#include "apps/viewer/scene/cut_marks.hpp"
#include "apps/viewer/scene/layer_prop.hpp"
#include "apps/viewer/scene/markers.hpp"
#include "apps/viewer/scene/measure_marks.hpp"
#include "apps/viewer/scene/view_space.hpp"
#include "pictures/vtk/props.hpp"

namespace palpate::viewer {
namespace {

constexpr double finer = 0.2;        // of the distance dragged, with Shift held
constexpr double notch_px = 15;      // a notch of the wheel in depth, as if dragged so far
constexpr double notch_zoom = 1.15;  // a notch of the wheel
constexpr double zoom_px = 150;      // dragged so far the scale doubles or halves

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

}  // namespace

struct Scene::Parts {
    BackgroundRenderer background;
    RenderRequest wanted;  // look, crosshair; changed() fills in the rest
    std::optional<Snapshot> snapshot;
    double brush = 0;
    std::vector<Measurement> measurements;
    std::optional<double> pressed;  // to this level
    std::shared_ptr<const RenderMesh> patch;
    Vec3 patched = Vec3::Zero();  // where, and at which level
    double patched_level = std::nan("");
    bool outdated = true;  // something was set since the layers were drawn

    vtkNew<vtkGenericOpenGLRenderWindow> window;
    vtkNew<vtkRenderer> front, overlay;
    vtkNew<LayerProp> solid, glass;
    Annotations annotations{2};
    std::unique_ptr<Markers> markers;
    std::unique_ptr<CutMarks> cut;
    std::unique_ptr<MeasureMarks> measures;

    Parts() {
        vtkTimerLog::LoggingOff();  // one log for all threads, unprotected; windows write into it
        window->SetMultiSamples(0);
        window->SetNumberOfLayers(3);
        for (vtkRenderer* renderer : {front.Get(), overlay.Get()}) pictures::light(*renderer);
        overlay->SetLayer(1);
        overlay->SetActiveCamera(front->GetActiveCamera());
        front->AddViewProp(solid);
        markers = std::make_unique<Markers>(*front, *overlay);
        cut = std::make_unique<CutMarks>(*front);
        measures = std::make_unique<MeasureMarks>(*overlay, annotations.writing());
        front->AddViewProp(glass);  // after all that it may cover
        for (vtkRenderer* renderer :
             {front.Get(), overlay.Get(), &annotations.writing(), &annotations.orientation()}) {
            window->AddRenderer(renderer);
        }
    }
};

Scene::Scene(QWidget* parent) : QVTKOpenGLNativeWidget(parent), parts_(std::make_unique<Parts>()) {
    setObjectName("scene");
    setAccessibleName("3-D view");
    setFocusPolicy(Qt::StrongFocus);
    setMinimumSize(120, 90);
    setMouseTracking(true);
    setRenderWindow(parts_->window.Get());
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
    parts_->snapshot.reset();
    parts_->pressed.reset();
    parts_->patched_level = std::nan("");
    parts_->wanted.crosshair = physical_centre(field.geometry());
    parts_->background.set_field(field, isovalue);
    reset_camera();
    changed();
}

void Scene::update_field(const Field& field, const std::optional<SampleBox>& changed) {
    parts_->background.update_field(field, changed);
    if (parts_->snapshot) refresh();  // the lattice round the proxy is that of the new version
}

void Scene::clear() {
    parts_->snapshot.reset();
    parts_->background.clear();
    refresh();
    changed();
}

void Scene::set_isovalue(double isovalue) {
    parts_->background.set_isovalue(isovalue);
}

void Scene::set_look(const Look& look) {
    parts_->wanted.look = look;
    refresh();
    changed();
}

void Scene::set_pressed(const std::optional<double>& level) {
    if (level == parts_->pressed) return;
    const bool was = parts_->pressed.has_value();
    parts_->pressed = level;
    refresh();
    if (was != level.has_value()) changed();
}

void Scene::show_snapshot(const std::optional<Snapshot>& snapshot) {
    const bool was = parts_->snapshot.has_value();
    if (!snapshot && !was) return;
    constexpr double unseen_px = 0.1;
    if (snapshot && was &&
        looks_same(*snapshot, *parts_->snapshot, unseen_px * mm_per_pixel(camera_, view_size()))) {
        return;
    }
    parts_->snapshot = snapshot;
    refresh();
}

void Scene::set_crosshair(const Vec3& physical) {
    parts_->wanted.crosshair = physical;
    if (parts_->wanted.look.slices) changed();
}

void Scene::set_hand(Hand hand) {
    hand_ = hand;
    setCursor(hand == Hand::probe ? Qt::CrossCursor : Qt::ArrowCursor);
}

void Scene::set_measuring(bool measuring) {
    measuring_ = measuring;
    setCursor(measuring || hand_ == Hand::probe ? Qt::CrossCursor : Qt::ArrowCursor);
}

void Scene::set_measurements(const std::vector<Measurement>& measurements) {
    parts_->measurements = measurements;
    refresh();
}

void Scene::set_overlay(std::vector<DrawnSurface> surfaces) {
    parts_->background.set_overlay(std::move(surfaces));
}

void Scene::set_brush(double radius) {
    parts_->brush = radius;
    refresh();
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
    Q_EMIT camera_moved();
}

void Scene::look_from(const pictures::View& view) {
    pictures::Camera camera = camera_;
    camera.towards_viewer = view.towards_viewer;
    camera.up = view.up;
    set_camera(camera);
}

void Scene::reset_camera() {
    if (!parts_->background.field()) return;
    const Geometry& geometry = parts_->background.field()->geometry();
    move_camera(whole(geometry, pictures::natural_view(geometry, Vec3::Zero()), view_size()));
    fitted_ = true;
}

void Scene::changed() {
    RenderRequest request = parts_->wanted;
    request.background = background_of(palette());
    request.ink = ink_of(palette());
    request.camera = camera_;
    constexpr double glass = 0.25;
    if (parts_->pressed) {
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

/// A patch stays until the proxy has moved by a part of a voxel.
std::optional<Contact> Scene::contact(const Field& field) {
    const Look& look = parts_->wanted.look;
    auto contact = contact_of(parts_->snapshot, field, look.tetrahedra || look.planes);
    if (!contact) return contact;
    contact->brush = parts_->brush;
    if (!parts_->pressed || !look.surface) return contact;
    const double unmoved = 0.5 * field.geometry().spacing.minCoeff();
    if (!((contact->scp - parts_->patched).norm() < unmoved) ||
        parts_->patched_level != *parts_->pressed) {
        parts_->patch = local_patch(field, contact->scp, *parts_->pressed);
        parts_->patched = contact->scp;
        parts_->patched_level = *parts_->pressed;
    }
    contact->patch = parts_->patch;
    return contact;
}

void Scene::lay_out() {
    const auto& shown = parts_->background.shown();
    // The camera of the image shown: while that lags, the probe stays in place on the surface.
    const pictures::Camera& camera = shown ? shown->camera : camera_;
    const auto& field = parts_->background.field();
    const double ratio = devicePixelRatioF();
    const Colour background = background_of(palette()), ink = ink_of(palette());
    parts_->front->SetBackground(background.red, background.green, background.blue);
    shown ? parts_->solid->set_layer(shown, shown->solid, false) : parts_->solid->clear();
    shown ? parts_->glass->set_layer(shown, shown->glass, true) : parts_->glass->clear();
    const Look& look = parts_->wanted.look;
    if (field) {
        const Vec3 origin = physical_centre(field->geometry());
        direct(*parts_->front->GetActiveCamera(), camera, origin, reach_of(field->geometry()));
        const double voxel = field->geometry().spacing.mean();
        const auto contact = this->contact(*field);
        const double pixel = mm_per_pixel(camera, view_size());
        parts_->markers->show(contact, look, origin, pixel, voxel, ink, ratio);
        parts_->cut->show(look, field->geometry(), origin, pixel, ratio, held_);
        parts_->measures->show(parts_->measurements, {origin, camera, view_size(), ratio,
                                                      ratio * QFontMetricsF(font()).ascent()});
    } else {
        parts_->measures->show({}, {});
        parts_->cut->hide();
        parts_->markers->show({}, look, Vec3::Zero(), 1, 1, ink, ratio);
    }
    Annotations::Content annotations;
    annotations.orientation = look.orientation && field;
    annotations.scale_bar = look.scale_bar && field;
    annotations.camera = camera;
    annotations.width = static_cast<int>(std::lround(width() * ratio));
    annotations.height = static_cast<int>(std::lround(height() * ratio));
    annotations.em = ratio * QFontMetricsF(font()).ascent();
    annotations.ink = ink;
    parts_->annotations.show(annotations);
    parts_->outdated = false;
}

void Scene::resizeEvent(QResizeEvent* event) {
    QVTKOpenGLNativeWidget::resizeEvent(event);
    if (fitted_ && parts_->background.field()) {
        reset_camera();
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

Scene::Drag Scene::drag_of(const QMouseEvent& event) const {
    const bool probe = hand_ == Hand::probe;
    const Qt::KeyboardModifiers keys = event.modifiers();
    switch (event.button()) {
        case Qt::LeftButton:
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

/// Of the cut, near the pointer.
std::optional<std::size_t> Scene::handle_at(const QPointF& at) const {
    constexpr double reach_px = 10;
    const auto& field = parts_->background.field();
    if (!field) return std::nullopt;
    const double arm = cut_arm_px * mm_per_pixel(camera_, view_size());
    const auto handles = handles_of(parts_->wanted.look, field->geometry(), arm);
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
    held_from_ = handles_of(parts_->wanted.look, geometry, arm).at(held_.value());
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
    set_look(with_handle_at(parts_->wanted.look, geometry, held_.value(), held_to_));
    Q_EMIT cut_moved(parts_->wanted.look);
}

void Scene::mousePressEvent(QMouseEvent* event) {
    if (drag_ != Drag::none) return;  // one button after the other
    drag_ = drag_of(*event);
    drag_from_ = drag_start_ = event->localPos();
    event->accept();
    if (measuring_ && event->button() == Qt::LeftButton) {
        drag_ = Drag::none;
        if (const auto at = surface_at(drag_from_)) Q_EMIT point_chosen(*at);
        return;
    }
    if (event->button() == Qt::LeftButton) {
        show_held(handle_at(drag_from_));
        if (held_) hold_handle();
    }
    const bool touches = drag_ == Drag::probe && !(event->modifiers() & Qt::ShiftModifier);
    if (touches && parts_->background.field()) {
        Q_EMIT probe_pressed(point_at(camera_, view_size(), {drag_from_.x(), drag_from_.y()}));
    }
}

void Scene::mouseMoveEvent(QMouseEvent* event) {
    const QPointF by = event->localPos() - drag_from_;
    drag_from_ = event->localPos();
    if (by.isNull() || !parts_->background.field()) return;
    if (drag_ == Drag::none) show_held(handle_at(drag_from_));
    if (drag_ == Drag::none && measuring_) {
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
    const auto x = static_cast<int>(pixel.x() * shown->width / width());
    const int y = shown->height - 1 - static_cast<int>(pixel.y() * shown->height / height());
    if (x < 0 || y < 0 || x >= shown->width || y >= shown->height) return std::nullopt;
    const auto depth_at = [&](const Layer& layer) {
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
    if (hand_ == Hand::probe && !(event->modifiers() & Qt::ControlModifier)) {
        const double part = event->modifiers() & Qt::ShiftModifier ? finer : 1;
        const double into = part * notches * notch_px * mm_per_pixel(camera_, size);
        Q_EMIT probe_dragged(-into * axes_of(camera_).towards_viewer);
        return;
    }
    const QPointF at = event->position();
    move_camera(zoomed(camera_, size, std::pow(notch_zoom, notches), {at.x(), at.y()}));
}

}  // namespace palpate::viewer
