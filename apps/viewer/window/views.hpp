// The views of a volume: the scene, three slices beside it, and the crosshair that they share.
#pragma once

#include <QWidget>
#include <array>
#include <memory>
#include <optional>

#include "apps/viewer/model/shown.hpp"
#include "apps/viewer/scene/render_request.hpp"
#include "palpate/servo.hpp"

class QPushButton;
class QSplitter;

namespace palpate::viewer {

class Scene;
class SlicePane;

class Views : public QWidget {
    Q_OBJECT

  public:
    /// `make_painter`: as of Scene.
    explicit Views(MakePainter make_painter, QWidget* parent = nullptr);

    /// `counted`: as SlicePane::set_field().
    void set_field(const Field& field, double isovalue,
                   const std::optional<Geometry>& counted = {});
    /// Another version of the data that are shown: edited, or at another moment.
    void update_field(const Field& field);
    void clear();
    void set_shown(const Shown& shown);
    const Shown& shown() const { return shown_; }
    /// Up to 60 times a second. The crosshair follows the chosen hand.
    void show_snapshots(const HandSnapshots& hands, int chosen);
    /// The crosshair follows the probe, once it has touched something.
    void set_follow(bool follow) { follow_ = follow; }
    bool follows() const { return follow_; }
    /// What the files do not say of a grid, on a button over the main pane; empty: none.
    void set_missing(const QString& words, const QString& tip);
    /// Puts that button `top` pixels below the upper edge of the scene, or over the lower edge of a
    /// slice that is alone, whose words are above.
    void place_missing(int top);
    void show_slices(bool shown);
    bool slices_shown() const { return slices_shown_; }
    /// Beside: the slices in a column beside the scene. Four: all panes of the same size, the
    /// sagittal slice below the scene.
    enum class Arrangement { beside, four };
    void arrange(Arrangement arrangement);
    /// Shows this pane alone, or again all of them.
    void toggle_alone(QWidget* pane);
    /// Shows a slice alone: the axial, or, where one is alone already, the next.
    void show_next_slice();
    /// The pane that is shown alone, or null.
    const QWidget* alone() const { return alone_; }
    /// That, or the scene.
    QWidget& main_pane();

    Scene& scene() { return *scene_; }
    SlicePane& slice(int axis) { return *slices_.at(static_cast<std::size_t>(axis)); }

  Q_SIGNALS:
    /// The user asks the probe to go to a point of a slice [mm, physical].
    void probe_aimed(const palpate::Vec3& to);
    /// In any pane, or by the wheel: the motion of the probe [mm, physical].
    void probe_dragged(const palpate::Vec3& by);
    /// A pane was enlarged, or all are shown again.
    void double_clicked();
    /// The button of set_missing() was pressed.
    void missing_asked();
    /// While measuring.
    void point_chosen(const palpate::Vec3& at);
    void point_pointed_at(const palpate::Vec3& at);

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    template <class Tell>
    void in_all(Tell tell);
    bool follows_double_click(const QMouseEvent& press);
    void choose_crosshair(const Vec3& physical);
    void restore_crosshair();
    std::optional<Vec3> on_surface(const Vec3& seen) const;
    void order_panes();
    void show_panes();

    Scene* scene_;
    std::optional<Field> field_;         // as it is shown
    std::array<SlicePane*, 3> slices_;   // by the axis of the grid
    std::array<SlicePane*, 3> by_body_;  // sagittal, coronal, axial
    Arrangement arrangement_ = Arrangement::beside;
    QPushButton* missing_;
    QSplitter *across_, *left_, *down_;
    QWidget* alone_ = nullptr;
    bool slices_shown_ = true;
    Shown shown_;
    bool follow_ = true, touched_ = false;
    // Before the last press in a slice, for a double click to restore.
    Vec3 crosshair_before_ = Vec3::Zero();
    bool follow_before_ = true;
    // The last press of the left button, and whether it was the second of a double click or later.
    ulong pressed_time_ = 0;  // [ms] of the window system
    QPoint pressed_;          // on the screen
    bool clicked_twice_ = false;
};

}  // namespace palpate::viewer
