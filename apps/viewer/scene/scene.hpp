// The 3-D view of a volume and of the hand that feels it. It only observes: setters choose what is
// shown, signals report what the user does with the mouse.
#pragma once

#include <QVTKOpenGLNativeWidget.h>
#include <QImage>
#include <QTimer>

#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/detail.hpp"
#include "apps/viewer/model/shown.hpp"
#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/navigation.hpp"
#include "apps/viewer/scene/render_request.hpp"
#include "palpate/servo.hpp"
#include "pictures/scene.hpp"
#include "pictures/view.hpp"

namespace palpate::viewer {

struct DrawnSurface;
struct ScenePatch;

/// Parallel projection. Painters render the static part (surface, volume, slices, box), usually on
/// threads of their own, quickly while something changes and finely after that; the widget draws
/// hand, proxy and force over the newest image. Points are physical [mm].
class Scene : public QVTKOpenGLNativeWidget {
    Q_OBJECT
  public:
    explicit Scene(QWidget* parent = nullptr, MakePainter make_painter = &make_render_thread);
    /// Cancels all rendering and waits for the threads, a few milliseconds.
    ~Scene() override;

    /// New data, seen as a whole; the extraction of its surface starts. An isovalue that is not
    /// finite shows no surface and is a problem().
    void set_field(const Field& field, double isovalue);
    /// Another version of the data that are shown, on the same grid: edited, or at another moment.
    /// Camera, probe and crosshair stay. As often as versions come: the newest is shown. Throws
    /// std::invalid_argument where nothing, or another grid, is shown.
    void update_field(const Field& field);
    /// A finer part of the data, whose surface is drawn in place of theirs; until the next
    /// set_field(). Nothing: none.
    void set_patch(const std::optional<ScenePatch>& patch);
    /// Points of what is seen; nothing while nothing is shown.
    std::optional<SeenPoints> seen_points() const;
    bool is_in_view(const Vec3& point) const;
    /// The picture is the fine one of the newest camera and look; a patch may still come.
    bool shows_whole() const;
    void clear();
    /// With another isovalue the surface is extracted again in the background, coarse first; the
    /// newest one wins.
    void set_shown(const Shown& shown);
    const Shown& shown() const;
    /// As often as the screen shows; nothing: no such hand. Hands are numbered from 1.
    void show_snapshot(const std::optional<Snapshot>& snapshot, int hand = 1);
    /// Surfaces of an overlay, from the middle of the grid. Until clear().
    void set_overlay(std::vector<DrawnSurface> surfaces);

    ViewSize view_size() const;
    pictures::Camera camera() const { return camera_; }
    /// Throws std::invalid_argument for one that cannot be looked through.
    void set_camera(const pictures::Camera& camera);
    /// From another side, with the same focus and zoom.
    void look_from(const pictures::View& view);
    /// The whole volume from where it shows most.
    void reset_camera();
    /// The whole volume from the same side as now.
    void show_whole();

    /// True if all is shown at full quality and nothing is under way.
    bool settled() const;
    /// What is shown, in device pixels.
    QImage picture();
    /// How long a picture took [s], smoothed over the last ones while things moved.
    double frame_seconds() const;
    /// True if graphics hardware paints; known after the first picture.
    bool on_hardware() const;

  Q_SIGNALS:
    /// Hand motion asked for with mouse or wheel, which are the probe's [mm, physical].
    void probe_dragged(const palpate::Vec3& by);
    /// The tool is to be turned, about its reference point: a rotation vector [radians, physical
    /// axes].
    void tool_turned(const palpate::Vec3& rotation);
    /// The left button went down to move the probe, without Shift: `at` lies under the pointer, in
    /// the plane through the camera's focus [mm, physical].
    void probe_pressed(const palpate::Vec3& at);
    void probe_released();
    /// While measuring: the point of a surface or volume under the pointer [mm, physical].
    void point_chosen(const palpate::Vec3& at);
    void point_pointed_at(const palpate::Vec3& at);
    /// The cut was moved with the mouse; it is shown already.
    void cut_moved(const palpate::viewer::Look& look);
    /// The surface is shown as finely as it will be, `seconds` after it was asked for.
    void surface_ready(double isovalue, double seconds);
    void problem(const QString& what);

  protected:
    void resizeEvent(QResizeEvent* event) override;
    void showEvent(QShowEvent* event) override;
    void changeEvent(QEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

  private:
    struct Parts;
    enum class Drag { none, turn, pan, zoom, probe, tool, handle };

    Drag drag_of(const QMouseEvent& event) const;
    std::optional<Vec3> surface_at(const QPointF& at) const;
    std::optional<std::size_t> handle_at(const QPointF& at) const;
    void show_held(std::optional<std::size_t> handle);
    void hold_handle();
    void move_handle(const QPointF& by);
    void move_camera(const pictures::Camera& camera);
    void changed();
    void refresh();
    void lay_out();
    void show_patch(const Field& field);
    const Field& finest_at_proxy(int hand, const Field& field) const;

    std::unique_ptr<Parts> parts_;
    QTimer refresh_;
    pictures::Camera camera_;
    bool fitted_ = true;  // the camera shows the whole volume, also after a change of size
    Drag drag_ = Drag::none;
    QPointF drag_from_, drag_start_;
    bool clicks_ = false;              // the button went down to touch, and did not drag yet
    std::optional<std::size_t> held_;  // the handle of the cut under the pointer
    CutHandle held_from_;              // as it was when the drag began
    Vec3 held_to_ = Vec3::Zero();      // where the drag has led
};

}  // namespace palpate::viewer
