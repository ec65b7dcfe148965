// The histogram with the isovalue as a line to drag, the level felt as a second line, suggested
// levels as ticks, ranges of interest as bands, and a curve.
#pragma once

#include <QColor>
#include <QWidget>

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "apps/viewer/panel/level_axis.hpp"

namespace palpate::viewer {

/// A level in the colour of its surface.
struct LevelMark {
    double level = 0;
    QColor colour;
    std::function<void(double level)> moved;  ///< by dragging, between `low` and `high`
    std::function<void()> pressed = [] {};
    QString name = {};  ///< stands beside its line; empty: nothing
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
};

/// Its own state is only the visible range and the choice. A change by mouse or keys is emitted as
/// a signal, and shown when the owner sets the new values.
///
/// Mouse: press or drag in the plot moves the level; a tick on the upper edge is taken exactly;
/// bands are moved and resized by their strip on the lower edge; shift-drag makes a new one; right
/// click or Del on a band deletes it. Control and wheel zooms, shift and wheel moves what is seen.
/// Keys: arrows one step, Page 10, Home and End, Ctrl+0 shows all again.
class LevelChart : public QWidget {
    Q_OBJECT

  public:
    LevelChart();

    /// New data, or none; `suggested` are levels that are worth feeling.
    void set_data(const run::Histogram& histogram, const std::vector<double>& suggested);
    /// The isovalue. NaN: there is none, and no bands. The whole line of a mark can then be
    /// dragged, and arrow keys move the curve's knots.
    void set_level(double level);
    double level() const { return level_; }
    /// The level felt now; NaN: none to show.
    void set_felt(double level);
    double felt() const { return felt_; }
    void set_bands(const Ranges& bands);
    const Ranges& bands() const { return bands_; }
    /// Further levels, as lines with a grip below.
    void set_marks(std::vector<LevelMark> marks);
    /// Without knots: no curve. Its scale does not change while something is dragged.
    void set_curve(const CurveLine& curve);
    const CurveLine& curve() const { return curve_; }
    /// The knot that keys move, or -1.
    int held_knot() const { return knot_; }
    void hold_knot(int knot) { choose(knot, -1); }
    /// Changes a knot, as dragging it does.
    void put_knot(int knot, const Curve::Knot& to);
    /// Where a knot is drawn [logical pixels].
    QPointF place_of(std::size_t knot) const;
    /// What an arrow key moves the level by [data units].
    double fine_step() const;
    /// The visible range, and the whole of the data.
    LevelAxis axis() const;
    LevelAxis whole_axis() const;
    /// The strip in which bands are dragged [logical pixels].
    QRectF strip() const;

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  Q_SIGNALS:
    void level_moved(double level);
    void bands_moved(const palpate::viewer::Ranges& bands);
    void bands_settled();  ///< the drag is over
    void band_added(const palpate::DensityRange& range);
    void band_deleted(int band);
    void curve_changed(const palpate::viewer::Knots& knots,
                       const std::vector<palpate::viewer::Colour>& colours);
    void knot_held(int knot);
    void knot_activated(int knot);  ///< by a double click or Return

  protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void contextMenuEvent(QContextMenuEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

  private:
    /// Something that can be dragged, and what dragging it does.
    struct Handle {
        Qt::CursorShape cursor = Qt::ArrowCursor;
        std::function<void()> press = [] {};
        std::function<void(const QPointF& to)> drag = [](const QPointF&) {};
        std::function<void()> release = [] {};
        int knot = -1, band = -1;  // chosen by it
    };

    Handle handle_at(const QPointF& at);
    Handle knot_handle(int knot);
    Handle band_handle(double x);
    Handle new_band_handle(double x);
    int knot_at(const QPointF& at) const;
    bool have_level() const;
    void choose(int knot, int band);
    void ask_level(double level);
    void step_level(double steps);
    Curve::Knot knot_of(const QPointF& at) const;
    void ask_curve(const CurveLine& curve, int chosen);
    void add_knot(const QPointF& at);
    void remove_knot(int knot);
    bool level_key(int key, double many);
    bool knot_key(int key, double many);
    QRectF plot() const;
    double text_height() const;
    void paint_bands(QPainter& painter) const;
    void paint_levels(QPainter& painter) const;
    void paint_curve(QPainter& painter) const;
    void paint_ends(QPainter& painter) const;

    run::Histogram histogram_;
    std::vector<double> suggested_;
    double level_ = std::numeric_limits<double>::quiet_NaN();
    double felt_ = std::numeric_limits<double>::quiet_NaN();
    Ranges bands_;
    std::vector<LevelMark> marks_;
    CurveLine curve_;

    LevelView view_;
    int knot_ = -1, band_ = -1;  // chosen, or -1
    std::optional<Handle> hold_;
    std::optional<DensityRange> new_band_;
    QPointF pressed_at_;
    bool activates_ = false;  // the knot, by a second press that has not become a drag
    int wheel_ = 0;           // eighths of degrees that make no step yet
};

}  // namespace palpate::viewer
