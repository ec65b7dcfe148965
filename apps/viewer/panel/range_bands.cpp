// Finds, drags and draws bands.
#include "apps/viewer/panel/range_bands.hpp"

#include <QPainter>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::viewer {
namespace {

/// Apart from each other and from the colours of HIP, SCP and force.
constexpr std::array<QRgb, 6> colours{0xffcc79a7, 0xffe69f00, 0xff56b4e9,
                                      0xff9a8fd8, 0xfff0e442, 0xff8c6d31};

}  // namespace

BandGrip band_at(const Ranges& ranges, const LevelAxis& axis, double x, double reach) {
    BandGrip best;
    double nearest = reach;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const double low = axis.x_of(ranges[i].low);
        const double high = axis.x_of(ranges[i].high);
        const auto band = static_cast<int>(i);
        // Of two ends in one place the one on the pointer's side, or a closed band could not open.
        const double to_low = std::abs(x - low) - (x < low ? 0.01 : 0);
        const double to_high = std::abs(x - high) - (x > high ? 0.01 : 0);
        if (std::isfinite(ranges[i].low) && to_low < nearest) {
            nearest = to_low;
            best = {band, Grip::low};
        }
        if (std::isfinite(ranges[i].high) && to_high < nearest) {
            nearest = to_high;
            best = {band, Grip::high};
        }
        if (best.grip == Grip::none && x > low && x < high) best = {band, Grip::whole};
    }
    return best;
}

DensityRange dragged(const DensityRange& start, Grip grip, double held_at, double level,
                     const LevelAxis& axis) {
    DensityRange range = start;
    if (grip == Grip::low) range.low = std::min(level, start.high);
    if (grip == Grip::high) range.high = std::max(level, start.low);
    if (grip != Grip::whole) return range;
    double by = level - held_at;
    if (std::isfinite(start.high)) by = std::min(by, std::max(0.0, axis.high - start.high));
    if (std::isfinite(start.low)) by = std::max(by, std::min(0.0, axis.low - start.low));
    range.low += by;
    range.high += by;
    return range;
}

QColor band_colour(int band) {
    return QColor::fromRgb(colours[static_cast<std::size_t>(band) % colours.size()]);
}

void paint_bands(QPainter& painter, const Ranges& ranges, const LevelAxis& axis, const QRectF& plot,
                 const QRectF& strip, int chosen) {
    painter.save();
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const auto band = static_cast<int>(i);
        const double low = axis.x_of(ranges[i].low);
        const double high = std::max(axis.x_of(ranges[i].high), low + 1);
        QColor colour = band_colour(band);
        colour.setAlphaF(0.28);
        painter.fillRect(QRectF(QPointF(low, plot.top()), QPointF(high, plot.bottom())), colour);
        colour.setAlphaF(1);
        const QRectF grip(QPointF(low, strip.top()), QPointF(high, strip.bottom()));
        painter.fillRect(grip, colour);
        painter.setPen(QPen(colour, 1));
        if (std::isfinite(ranges[i].low))
            painter.drawLine(QPointF(low, plot.top()), grip.topLeft());
        if (std::isfinite(ranges[i].high)) {
            painter.drawLine(QPointF(high, plot.top()), grip.topRight());
        }
        if (band == chosen) {
            painter.setPen(QPen(painter.pen().color().darker(190), 1.5));
            painter.drawRect(grip.adjusted(0.75, 0.75, -0.75, -0.75));
        }
    }
    painter.restore();
}

}  // namespace palpate::viewer
