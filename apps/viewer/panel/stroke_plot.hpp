// A plot of the force of a stroke through layers.
#pragma once

#include <QWidget>

#include "apps/viewer/model/layer_set.hpp"
#include "apps/viewer/model/measurement.hpp"

namespace palpate::viewer {

/// The force of a stroke through layers over its depth, in the layers' colours.
class StrokePlot : public QWidget {
    Q_OBJECT

  public:
    StrokePlot();

    /// Takes a snapshot of a session with these layers.
    void add(const Snapshot& now, const SharedLayers& layers);
    void clear();
    /// Of depths.
    void set_ruler(const Ruler& ruler) { ruler_ = ruler; }
    const Stroke& stroke() const { return stroke_; }

    QSize sizeHint() const override;
    QSize minimumSizeHint() const override;

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    QRectF plot() const;
    QColor colour_of(int layer) const;
    void paint_axes(QPainter& painter, double deepest, double highest) const;
    void paint_key(QPainter& painter) const;

    Stroke stroke_;
    SharedLayers layers_;
    Ruler ruler_;
};

}  // namespace palpate::viewer
