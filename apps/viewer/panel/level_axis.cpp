// Converts between levels and pixels, draws the histogram, and changes ranges and curves.
#include "apps/viewer/panel/level_axis.hpp"

#include <QPainter>
#include <QPainterPath>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate::viewer {

double LevelAxis::x_of(double level) const {
    const double part = high > low ? (std::clamp(level, low, high) - low) / (high - low) : 0;
    return std::lerp(left, right, part);
}

double LevelAxis::level_of(double x) const {
    return std::lerp(low, high, std::clamp((x - left) / (right - left), 0.0, 1.0));
}

double LevelAxis::step() const {
    return std::pow(10.0, std::floor(std::log10((high - low) / std::max(1.0, right - left))));
}

double LevelAxis::round_level_of(double x) const {
    return std::clamp(rounded_to(level_of(x), step()), low, high);
}

LevelAxis LevelView::seen(const LevelAxis& whole) const {
    LevelAxis axis = whole;
    axis.low = std::lerp(whole.low, whole.high, from);
    axis.high = std::lerp(whole.low, whole.high, to);
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
    const double half = width == 0 ? 1.5 : 0;  // all samples have one value
    QPainterPath bars;
    bars.setFillRule(Qt::WindingFill);
    for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
        const double from = first + static_cast<double>(i) * width;
        const double left = axis.x_of(from) - half, right = axis.x_of(from + width) + half;
        const double height = scale * std::log1p(static_cast<double>(histogram.counts[i]));
        bars.addRect(left, plot.bottom() - height, right - left, height);
    }
    painter.fillPath(bars, colour);
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
    // Apart from each other and from the colours of HIP, SCP and force.
    constexpr std::array<QRgb, 6> colours{0xffcc79a7, 0xffe69f00, 0xff56b4e9,
                                          0xff9a8fd8, 0xfff0e442, 0xff8c6d31};
    return QColor::fromRgb(colours[static_cast<std::size_t>(band) % colours.size()]);
}

void CurveLine::fit() {
    constexpr double room = 1.25;
    if (!colours.empty()) return;
    double highest = 0;
    for (const Curve::Knot& knot : knots) {
        if (std::isfinite(knot.value)) highest = std::max(highest, knot.value);
    }
    top = highest > 0 ? room * highest : least;
}

void CurveLine::put(std::size_t knot, Curve::Knot to, double gap) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double low = knot > 0 ? knots[knot - 1].at + gap : -infinity;
    const double high = knot + 1 < knots.size() ? knots[knot + 1].at - gap : infinity;
    // Between neighbours that are too close it stays where it is.
    to.at = low <= high ? std::clamp(to.at, low, high) : knots[knot].at;
    knots[knot] = to;
}

int CurveLine::add(const Curve::Knot& knot) {
    const auto behind = std::ranges::lower_bound(knots, knot.at, {}, &Curve::Knot::at);
    if (behind != knots.end() && behind->at == knot.at) return -1;
    const auto number = behind - knots.begin();
    if (!colours.empty()) {
        const auto right = std::min(static_cast<std::size_t>(number), knots.size() - 1);
        const std::size_t left = number > 0 ? static_cast<std::size_t>(number) - 1 : 0;
        const double t =
            left == right ? 0 : (knot.at - knots[left].at) / (knots[right].at - knots[left].at);
        colours.insert(colours.begin() + number, mixed(colours[left], colours[right], t));
    }
    knots.insert(behind, knot);
    return static_cast<int>(number);
}

bool CurveLine::remove(int knot) {
    if (knot < 0 || knots.size() <= fewest) return false;
    knots.erase(knots.begin() + knot);
    if (!colours.empty()) colours.erase(colours.begin() + knot);
    return true;
}

}  // namespace palpate::viewer
