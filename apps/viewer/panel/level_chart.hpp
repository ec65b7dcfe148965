// The histogram with the isovalue as a line to drag, the level felt as a second line, suggested
// levels as ticks and ranges of interest as bands.
#pragma once

#include <QColor>
#include <QWidget>

#include <limits>
#include <vector>

#include "apps/viewer/panel/level_axis.hpp"

namespace palpate::viewer {

/// A level in the colour of its surface.
struct LevelMark {
    double level = 0;
    QColor colour;
    /// Stands beside its line; empty: nothing.
    QString name = {};
    /// It is dragged between these.
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();

    bool operator==(const LevelMark&) const = default;
};

/// Mouse: press or drag in the plot moves the level; a tick on the upper edge is taken exactly;
/// bands are moved and resized by their strip on the lower edge; shift-drag makes a new one; right
/// click or Del on a band deletes it. Control and wheel zooms, shift and wheel moves what is seen.
/// Keys: arrows one step, Page 10, Home and End, Ctrl+0 shows all again.
class LevelChart : public QWidget {
    Q_OBJECT

  public:
    LevelChart();

    /// New data; `suggested` are levels that are worth feeling.
    void set_data(const run::Histogram& histogram, const std::vector<double>& suggested);
    void clear();
    /// Moves the line; emits nothing.
    void set_level(double level);
    double level() const { return level_; }
    /// The level felt now; NaN: none to show.
    void set_felt(double level);
    double felt() const { return felt_; }
    /// Bands; emits nothing. Ignored while a band is dragged.
    void set_bands(const Ranges& bands);
    /// Further levels, as lines with a grip below; emits nothing. Ignored while one is dragged.
    void set_marks(const std::vector<LevelMark>& marks);
    /// A curve over levels, with knots to drag; emits nothing. Ignored while one is dragged. No
    /// knots: none.
    void set_curve(const CurveLine& curve);
    const CurveLine& curve() const { return curve_; }
    /// The knot that keys move, or -1.
    int held_knot() const { return held_knot_; }
    void hold_knot(int knot);
    /// Where a knot is drawn [logical pixels].
    QPointF place_of(std::size_t knot) const;
    /// False: there are no isovalue and no bands, marks are held by their whole lines, and arrow
    /// keys are for the curve.
    void set_level_shown(bool shown);
    const Ranges& bands() const { return bands_; }
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
    void mark_chosen(int mark);
    void mark_moved(int mark, double level);
    void curve_changed(const palpate::viewer::Knots& knots);
    void knot_held(int knot);
    void knot_activated(int knot);  ///< by a double click or Return
    void band_added(const palpate::DensityRange& range);
    void band_deleted(int band);

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
    enum class Part { none, level, tick, mark, knot, band, fresh };
    /// What the pointer takes hold of, or would.
    struct Hold {
        Part part = Part::none;
        int at = -1;  // of ticks, marks, knots, bands
        Grip grip = Grip::none;
    };

    QRectF plot() const;
    double text_height() const;
    void choose_band(int band);
    void ask_level(double level);
    void step_level(double steps);
    int knot_at(const QPointF& at) const;
    Hold hold_at(const QPointF& at) const;
    void drag_to(const QPointF& at);
    void remove_knot(int knot);
    void curve_edited();
    bool step_knot(int key, double steps);
    bool have_bands() const { return level_shown_ && !bands_.empty(); }
    void paint_marks(QPainter& painter, const LevelAxis& axis) const;
    void show_cursor(const QPointF& at);
    void paint_ticks(QPainter& painter, const LevelAxis& axis) const;
    void paint_markers(QPainter& painter, const LevelAxis& axis) const;
    void paint_ends(QPainter& painter) const;

    run::Histogram histogram_;
    std::vector<double> suggested_;
    double level_ = 0;
    double felt_ = std::numeric_limits<double>::quiet_NaN();
    Ranges bands_;
    int chosen_ = -1;

    std::vector<LevelMark> marks_;
    CurveLine curve_;
    bool level_shown_ = true;

    Hold hold_;
    int held_knot_ = -1;
    QPointF pressed_at_;
    bool activates_ = false;     // the knot, by a second press that has not become a drag
    double held_at_ = 0;         // level under the pointer when the drag began
    DensityRange held_, fresh_;  // the band then; the one that is being made
    LevelView view_;
    int wheel_ = 0;  // eighths of degrees that make no step yet
};

}  // namespace palpate::viewer
