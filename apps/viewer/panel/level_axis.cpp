// Converts between levels and pixels, and draws histogram, bands and curve.
#include "apps/viewer/panel/level_axis.hpp"

#include <QLinearGradient>
#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/inputs.hpp"

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

namespace {

/// Apart from each other and from the colours of HIP, SCP and force.
constexpr std::array<QRgb, 6> colours{0xffcc79a7, 0xffe69f00, 0xff56b4e9,
                                      0xff9a8fd8, 0xfff0e442, 0xff8c6d31};

}  // namespace

BandGrip band_at(const Ranges& ranges, const LevelAxis& axis, double x, double reach) {
    BandGrip best;
    double nearest = reach;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const auto band = static_cast<int>(i);
        const auto& [low, high] = ranges[i];
        for (const Grip grip : {Grip::low, Grip::high}) {
            const double level = grip == Grip::low ? low : high, end = axis.x_of(level);
            // Of two ends in one place the one on the pointer's side, or a closed band could not
            // open.
            const bool outside = grip == Grip::low ? x < end : x > end;
            const double off = std::abs(x - end) - (outside ? 0.01 : 0);
            if (!std::isfinite(level) || off >= nearest) continue;
            nearest = off;
            best = {band, grip};
        }
        const bool inside = x > axis.x_of(low) && x < axis.x_of(high);
        if (best.grip == Grip::none && inside) best = {band, Grip::whole};
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

CurveLine line_of(const Knots& knots, double least, const QString& unit) {
    constexpr double room = 1.25;
    double highest = 0;
    for (const Curve::Knot& knot : knots) {
        if (std::isfinite(knot.value)) highest = std::max(highest, knot.value);
    }
    return {knots, highest > 0 ? room * highest : least, least, unit};
}

QPointF CurveLine::place_of(const Curve::Knot& knot, const LevelAxis& axis,
                            const QRectF& plot) const {
    const double part = std::clamp(knot.value / top, 0.0, 1.0);
    return {axis.x_of(knot.at), plot.bottom() - part * plot.height()};
}

Curve::Knot CurveLine::knot_of(const QPointF& at, const LevelAxis& axis, const QRectF& plot) const {
    const double part = std::clamp((plot.bottom() - at.y()) / plot.height(), 0.0, 1.0);
    const double digit = std::pow(10.0, std::floor(std::log10(top)) - 2);  // short numbers
    return {axis.round_level_of(at.x()), std::round(part * top / digit) * digit};
}

int CurveLine::knot_at(const QPointF& at, const LevelAxis& axis, const QRectF& plot,
                       double reach) const {
    int best = -1;
    for (std::size_t i = 0; i < knots.size(); ++i) {
        const QPointF away = place_of(knots[i], axis, plot) - at;
        const double distance = std::hypot(away.x(), away.y());
        if (distance > reach) continue;
        reach = distance;
        best = static_cast<int>(i);
    }
    return best;
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
    const auto behind =
        std::ranges::find_if(knots, [&](const Curve::Knot& one) { return one.at >= knot.at; });
    if (behind != knots.end() && behind->at == knot.at) return -1;
    const auto number = behind - knots.begin();
    if (!colours.empty()) {
        const auto last = static_cast<std::ptrdiff_t>(knots.size()) - 1;
        const auto left = std::size_t(std::max<std::ptrdiff_t>(number - 1, 0));
        const auto right = std::size_t(std::min(number, last));
        const double t =
            left == right ? 0 : (knot.at - knots[left].at) / (knots[right].at - knots[left].at);
        colours.insert(colours.begin() + number, mixed(colours[left], colours[right], t));
    }
    knots.insert(knots.begin() + number, knot);
    return static_cast<int>(number);
}

bool CurveLine::remove(int knot) {
    if (knot < 0 || knots.size() <= fewest) return false;
    knots.erase(knots.begin() + knot);
    if (!colours.empty()) colours.erase(colours.begin() + knot);
    return true;
}

/// The area below the line in the colours, and these alone below it.
void CurveLine::fill(QPainter& painter, const QPainterPath& line, const LevelAxis& axis,
                     const QRectF& plot) const {
    QLinearGradient shades(plot.left(), 0, plot.right(), 0);
    for (std::size_t i = 0; i < knots.size(); ++i) {
        const double part = (axis.x_of(knots[i].at) - plot.left()) / plot.width();
        shades.setColorAt(std::clamp(part, 0.0, 1.0), to_qt(colours[i]));
    }
    QPainterPath area = line;
    area.lineTo(plot.bottomRight());
    area.lineTo(plot.bottomLeft());
    painter.setOpacity(0.75 * painter.opacity());
    painter.fillPath(area, shades);
    painter.setOpacity(painter.opacity() / 0.75);
    const double high = 0.5 * painter.fontMetrics().height() - 3;
    painter.fillRect(QRectF(plot.left(), plot.bottom() + 3, plot.width(), high), shades);
}

/// Constant beyond the outer knots; the chosen one with its value.
void CurveLine::paint(QPainter& painter, const LevelAxis& axis, const QRectF& plot,
                      const QColor& colour, int chosen) const {
    if (knots.empty()) return;
    QPainterPath line(QPointF(plot.left(), place_of(knots.front(), axis, plot).y()));
    for (const Curve::Knot& knot : knots) line.lineTo(place_of(knot, axis, plot));
    line.lineTo(plot.right(), line.currentPosition().y());
    painter.save();
    if (!colours.empty()) fill(painter, line, axis, plot);
    painter.setPen(QPen(colour, 1.5));
    painter.setBrush(Qt::NoBrush);
    painter.drawPath(line);
    for (std::size_t i = 0; i < knots.size(); ++i) {
        const QPointF at = place_of(knots[i], axis, plot);
        const double radius = static_cast<int>(i) == chosen ? 4.5 : 3;
        painter.setBrush(colours.empty() ? colour : to_qt(colours[i]));
        painter.drawEllipse(at, radius, radius);
        if (static_cast<int>(i) != chosen) continue;
        QString text = number_text(knots[i].value, 3);
        if (!unit.isEmpty()) text += " " + unit;
        const double wide = painter.fontMetrics().horizontalAdvance(text);
        const double x = std::clamp(at.x() + 7, plot.left(), plot.right() - wide - 2);
        painter.drawText(
            QPointF(x, std::max(at.y() - 6, plot.top() + painter.fontMetrics().height())), text);
    }
    painter.restore();
}

}  // namespace palpate::viewer
