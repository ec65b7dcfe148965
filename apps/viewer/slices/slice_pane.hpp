// A pane that shows a slice of the volume: grey levels, contour of the isosurface, crosshair, hand
// and proxy. Mouse and keys work as in ITK-SNAP and 3D Slicer.
#pragma once

#include <QElapsedTimer>
#include <QImage>
#include <QTimer>
#include <QWidget>

#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/model/detail.hpp"
#include "apps/viewer/model/shown.hpp"
#include "apps/viewer/slices/plane.hpp"
#include "apps/viewer/slices/slice_picture.hpp"
#include "palpate/servo.hpp"

namespace palpate::viewer {

struct SliceWords;

/// Wheel: next slice. Left: crosshair; with Ctrl the probe, where it is the mouse (Shown). Right
/// drag: window and level. Middle drag: moves the picture. Ctrl and wheel: zoom. Double click: the
/// whole slice, the usual grey levels. Arrows, Page Up and Down, +, -, Home do the same by keys.
/// Points are physical [mm].
class SlicePane : public QWidget {
    Q_OBJECT

  public:
    /// `axis`: 0, 1 or 2, the grid axis that the slices lie across. Empty at first.
    explicit SlicePane(int axis, QWidget* parent = nullptr);

    /// Another volume: the crosshair goes to its centre, the whole slice is seen, the grey levels
    /// are the usual ones. For the same samples with another solid side or background all of these
    /// stay. `counted`: the grid in which slices are counted and stepped through, where the field
    /// is an overview of it.
    void set_field(const Field& field, double isovalue,
                   const std::optional<Geometry>& counted = {});
    /// Another version of the data that are shown, on the same grid: edited, or at another moment.
    /// Only image and contour change; redrawn as often as leaves most of the time to others, the
    /// newest last. Throws std::invalid_argument where nothing, or another grid,
    /// is shown.
    void update_field(const Field& field);
    /// A finer part of the data, drawn in their place; null: none.
    void set_detail(std::shared_ptr<const DetailField> detail);
    /// The part of the slice that is seen; nothing while the pane shows none.
    std::optional<SeenBox> seen() const;
    /// What set_detail() set, where the slice shows it; else null.
    const DetailField* shown_detail() const;
    void clear();
    /// A crosshair that is not finite stays where it was.
    void set_shown(Shown shown);
    const Shown& shown() const { return shown_; }
    /// Hand, proxy, spring and force; nothing: no such hand. The slice stays where it is.
    void show_snapshot(const std::optional<Snapshot>& snapshot, int hand = 1);
    /// The grey levels that it has.
    GreyWindow grey_window() const;

    /// As SlicePlane::anatomical; without a volume its own axis.
    int anatomical() const;
    /// Sagittal, Coronal or Axial, or XY, ...; empty without a volume.
    QString title() const;
    /// Where a point is drawn [pixels of the widget], and which point of the slice is drawn there.
    QPointF pixel_of(const Vec3& physical) const;
    Vec3 point_at(const QPointF& pixel) const;

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  Q_SIGNALS:
    /// By the user; the pane shows it already.
    void crosshair_chosen(const palpate::Vec3& physical);
    /// The point to which the probe is asked to go.
    void probe_aimed(const palpate::Vec3& physical);
    /// How far it is dragged from there.
    void probe_dragged(const palpate::Vec3& by);
    void window_chosen(const palpate::viewer::GreyWindow& window);
    /// While measuring: under the pointer [mm, physical].
    void point_chosen(const palpate::Vec3& at);
    void point_pointed_at(const palpate::Vec3& at);

  protected:
    bool event(QEvent* event) override;
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void leaveEvent(QEvent* event) override;

  private:
    /// The data of a volume that the pane holds.
    struct Content {
        SlicePlane plane;  ///< that slices are counted in
        SliceSamples samples;
        double layer = 0;                           ///< of the grid, that the picture shows
        std::shared_ptr<const DetailField> finer;   ///< of a part; null: none
        std::optional<SliceSamples> finer_samples;  ///< its own
        QImage picture;                             ///< grey levels and contour; null: to be made
        SliceStyle style;                           ///< of the picture
        std::optional<Field> newer;  ///< not yet in samples: another version of the same grid
        QElapsedTimer made;          ///< since then
        qint64 took_ms = 0;

        Content(const Field& field, const SlicePlane& counted)
            : plane(counted), samples(field, counted) {}
    };
    enum class Drag { none, crosshair, probe, window, move };
    struct Aim {
        QPointF at;  // [samples]
        double layer = 0;
    };

    const SlicePlane& plane() const { return content_->plane; }
    SliceMap map() const;
    double margin() const;
    double layer() const;
    double layer_in(const SlicePlane& other) const;
    std::optional<FinerSlice> finer_slice(const SliceMap& where);
    double value_there(const Vec3& physical) const;
    Vec3 in_data(Vec3 point) const;
    SliceStyle style() const;
    void picture_changed();
    void make_picture(const SliceMap& where);
    void choose(const Vec3& physical);
    void choose_at(const QPointF& pixel);
    Vec3 physical(const Aim& aim) const;
    void drag_probe(const Aim& to);
    void step_slice(int steps);
    double next_layer(double from, int steps) const;
    void zoom_at(const QPointF& pixel, double factor);
    void choose_window(const GreyWindow& window);
    void change_window(const QPointF& drag);
    void reset();
    std::vector<SliceWords> words_in() const;

    const int axis_;
    std::unique_ptr<Content> content_;  // null without a volume
    Shown shown_;
    HandSnapshots snapshots_;
    SliceView view_;
    Drag drag_ = Drag::none;
    Aim aimed_;  // where the pointer has led the probe
    QPointF drag_from_;
    std::optional<QPointF> pointer_;
    QTimer later_;
    int wheel_ = 0;  // [eighths of a degree] not yet a step
};

}  // namespace palpate::viewer
