// An editor of a transfer function over the histogram: its points are dragged, added, coloured and
// deleted.
#pragma once

#include <QWidget>

#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/level_axis.hpp"

namespace palpate::viewer {

/// Mouse: drag a point; double click adds one, or on one chooses its colour; right click deletes.
/// Keys: arrows move the chosen point (shift: farther), comma and period choose the one before and
/// after, Insert adds, Del deletes, Return its colour. Zoom as in the level chart.
class TransferEditor : public QWidget {
    Q_OBJECT

  public:
    TransferEditor();

    void set_data(const run::Histogram& histogram);
    /// Shows a function (one without points: none); emits nothing.
    void set_transfer(const TransferFunction& transfer);
    const TransferFunction& transfer() const { return transfer_; }
    /// The point that is chosen, or -1.
    int chosen() const { return chosen_; }
    void choose(int point);
    /// Changes the chosen point: its level stays between its neighbours.
    void change_chosen(const ControlPoint& to);
    /// Where a point is drawn [logical pixels].
    QPointF place_of(const ControlPoint& point) const;

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  Q_SIGNALS:
    /// The function that is shown was changed by hand; `preset` is empty then.
    void changed(const palpate::viewer::TransferFunction& transfer);
    void settled();  ///< a drag is over
    void point_chosen(int point);
    void colour_wanted(int point);

  protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;

  private:
    QRectF plot() const;
    LevelAxis axis() const;
    int point_at(const QPointF& at) const;
    ControlPoint under(const QPointF& at) const;
    void add(ControlPoint point);
    void remove(int point);
    void edited();
    void paint_function(QPainter& painter) const;

    run::Histogram histogram_;
    TransferFunction transfer_;
    int chosen_ = -1;
    bool dragging_ = false;
    LevelView view_;
};

}  // namespace palpate::viewer
