// Converts between levels and pixels, and draws the bars of the histogram.
#include "apps/viewer/panel/level_axis.hpp"

#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>

namespace palpate::viewer {

double LevelAxis::x_of(double level) const {
    const double part = (std::clamp(level, low, high) - low) / (high - low);
    return left + part * (right - left);
}

double LevelAxis::level_of(double x) const {
    const double part = std::clamp((x - left) / (right - left), 0.0, 1.0);
    return low + part * (high - low);
}

double LevelAxis::step() const {
    return std::pow(10.0, std::floor(std::log10((high - low) / std::max(1.0, right - left))));
}

double LevelAxis::round_level_of(double x) const {
    return std::clamp(rounded_to(level_of(x), step()), low, high);
}

LevelAxis LevelView::seen(const LevelAxis& whole) const {
    const double range = whole.high - whole.low;
    LevelAxis axis = whole;
    if (from > 0) axis.low = whole.low + from * range;
    if (to < 1) axis.high = whole.low + to * range;
    return axis.low < axis.high ? axis : whole;  // of data with few digits
}

void LevelView::zoom(double factor, double about) {
    constexpr double least = 1.0 / 256;
    const double width = std::clamp((to - from) / factor, least, 1.0);
    const double place = (about - from) / (to - from);
    from = std::clamp(about - place * width, 0.0, 1 - width);
    to = width == 1 ? 1 : from + width;
}

void LevelView::move(double part) {
    const double width = to - from;
    from = std::clamp(from + part * width, 0.0, 1 - width);
    to = from + width;
}

bool LevelView::wheel(const QWheelEvent& event, const LevelAxis& whole) {
    const double notches = (event.angleDelta().y() + event.angleDelta().x()) / 120.0;
    if (event.modifiers() & Qt::ControlModifier) {
        const double level = seen(whole).level_of(event.position().x());
        zoom(std::pow(1.25, notches), (level - whole.low) / (whole.high - whole.low));
        return true;
    }
    if (event.modifiers() & Qt::ShiftModifier) {
        move(-0.1 * notches);
        return true;
    }
    return false;
}

double rounded_to(double value, double unit) {
    // By 1 / unit where that is a whole number: 0.3 and not 0.30000000000000004.
    const double per_unit = std::round(1 / unit);
    const double rounded =
        unit < 1 ? std::round(value * per_unit) / per_unit : std::round(value / unit) * unit;
    return std::isfinite(rounded) ? rounded : value;
}

LevelAxis axis_of(const run::Histogram& histogram, const QRectF& plot) {
    LevelAxis axis{histogram.low, histogram.greatest, plot.left(),
                   std::max(plot.right(), plot.left() + 1)};
    if (!(axis.high > axis.low)) {
        const double room = std::max(0.5, 1e-3 * std::abs(axis.low));
        axis.low -= room;
        axis.high += room;
    }
    return axis;
}

void paint_histogram(QPainter& painter, const run::Histogram& histogram, const LevelAxis& axis,
                     const QRectF& plot, const QColor& colour) {
    if (histogram.counts.empty()) return;
    const auto most = std::max<std::int64_t>(1, *std::ranges::max_element(histogram.counts));
    const double scale = plot.height() / std::log1p(static_cast<double>(most));
    const double width = (histogram.high - histogram.low) / double(histogram.counts.size());
    // A whole number stands in the middle of its bar.
    const double first = histogram.low - (histogram.whole_numbers ? 0.5 : 0);
    QPainterPath bars(plot.bottomLeft());
    for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
        const double from = first + static_cast<double>(i) * width;
        double left = axis.x_of(from);
        double right = std::min(axis.x_of(from + width), plot.right());
        if (width == 0) {  // all samples have one value
            left -= 1.5;
            right += 1.5;
            bars.lineTo(left, plot.bottom());
        }
        const double top =
            plot.bottom() - scale * std::log1p(static_cast<double>(histogram.counts[i]));
        bars.lineTo(left, top);
        bars.lineTo(right, top);
        if (width == 0) bars.lineTo(right, plot.bottom());
    }
    bars.lineTo(plot.bottomRight());
    bars.closeSubpath();
    painter.fillPath(bars, colour);
}

bool is_dark(const QPalette& palette) {
    return palette.color(QPalette::Window).lightnessF() < 0.5;
}

QColor readable(const QColor& colour, const QPalette& palette) {
    return is_dark(palette) ? colour.lighter(155) : colour;
}

}  // namespace palpate::viewer
