// Draws force over depth.
#include "apps/viewer/panel/stroke_plot.hpp"

#include <QCoreApplication>
#include <QPainter>

#include <set>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/level_axis.hpp"

namespace palpate::viewer {

StrokePlot::StrokePlot() {
    named(this, "stroke_plot",
          tr("Force over depth: the stroke so far, from its first contact, in the colours of the "
             "layers touched.\nA stroke ends two seconds after the hand has left all layers."));
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void StrokePlot::add(const Snapshot& now, const SharedLayers& layers) {
    layers_ = layers;
    if (layers && stroke_.add(now)) update();
}

void StrokePlot::clear() {
    stroke_.clear();
    update();
}

QSize StrokePlot::sizeHint() const {
    return {18 * fontMetrics().height(), 8 * fontMetrics().height()};
}

QSize StrokePlot::minimumSizeHint() const {
    return {10 * fontMetrics().height(), 6 * fontMetrics().height()};
}

QRectF StrokePlot::plot() const {
    const double line = fontMetrics().height();
    return QRectF(rect()).adjusted(6, 3, -6, -(line + 4));
}

QColor StrokePlot::colour_of(int layer) const {
    const auto at = static_cast<std::size_t>(layer);
    if (layer < 0 || !layers_ || at >= layers_->layers.size()) {
        return palette().color(QPalette::PlaceholderText);
    }
    return readable(to_qt(palpate::viewer::colour_of(layers_->layers[at])), palette());
}

void StrokePlot::paint_axes(QPainter& painter, double deepest, double highest) const {
    const QRectF p = plot();
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(palette().color(QPalette::Mid), 1));
    painter.drawRect(p);
    painter.setPen(palette().color(QPalette::PlaceholderText));
    const QRectF below(p.left(), p.bottom() + 2, p.width(), fontMetrics().height());
    painter.drawText(below, Qt::AlignLeft, "0");
    painter.drawText(below, Qt::AlignHCenter, tr("depth"));
    painter.drawText(below, Qt::AlignRight,
                     number_text(deepest * ruler_.per_mm, 2) + " " +
                         QCoreApplication::translate("Units", ruler_.unit));
    painter.drawText(p.adjusted(3, 1, 0, 0), Qt::AlignLeft | Qt::AlignTop,
                     number_text(highest, 2) + " N");
}

/// The names of the layers that were touched, in their colours.
void StrokePlot::paint_key(QPainter& painter) const {
    std::set<int> touched;
    for (const Stroke::Point& point : stroke_.points()) {
        if (point.layer >= 0) touched.insert(point.layer);
    }
    QRectF line = plot().adjusted(0, 1, -4, 0);
    for (const int layer : touched) {
        if (!layers_ || static_cast<std::size_t>(layer) >= layers_->layers.size()) continue;
        painter.setPen(colour_of(layer));
        painter.drawText(
            line, Qt::AlignRight | Qt::AlignTop,
            QString::fromStdString(layers_->layers[static_cast<std::size_t>(layer)].name));
        line.setTop(line.top() + fontMetrics().height());
    }
}

void StrokePlot::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QRectF p = plot();
    painter.fillRect(p, palette().color(QPalette::Base));
    const auto& points = stroke_.points();
    if (points.size() < 2) {
        painter.setPen(palette().color(QPalette::PlaceholderText));
        painter.drawText(p, Qt::AlignCenter, tr("force over depth: press into a layer"));
        return;
    }
    // Round ends, so that the axes do not run along with the hand.
    double deepest = 1 / ruler_.per_mm, highest = 0.5;
    for (const Stroke::Point& point : points) {
        while (point.depth > deepest) deepest *= 2;
        while (point.force > highest) highest *= 2;
    }
    const LevelAxis depths{0, deepest, p.left(), p.right()},
        forces{0, highest, p.bottom(), p.top()};
    const auto place = [&](const Stroke::Point& point) {
        return QPointF(depths.x_of(point.depth), forces.x_of(point.force));
    };
    for (std::size_t i = 1; i < points.size(); ++i) {
        painter.setPen(QPen(colour_of(points[i].layer), 1.5));
        painter.drawLine(place(points[i - 1]), place(points[i]));
    }
    painter.setPen(Qt::NoPen);
    painter.setBrush(palette().color(QPalette::Text));
    painter.drawEllipse(place(points.back()), 2.5, 2.5);
    paint_axes(painter, deepest, highest);
    paint_key(painter);
}

}  // namespace palpate::viewer
