// Input of the level chart.
#include "apps/viewer/panel/level_chart.hpp"

#include <QContextMenuEvent>
#include <QKeyEvent>
#include <QMenu>
#include <QMouseEvent>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "apps/viewer/panel/inputs.hpp"

namespace palpate::viewer {
namespace {

constexpr double reach = 5;  // [logical pixels] distance within which the pointer takes hold
constexpr int jitter = 3;    // [logical pixels] of a pointer that clicks

/// The nearest within reach of a point on the axis, or -1.
template <class T>
int nearest(const std::vector<T>& all, const LevelAxis& axis, double x, auto level) {
    int best = -1;
    double least = reach + 1;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double off = std::abs(axis.x_of(std::invoke(level, all[i])) - x);
        if (off >= least) continue;
        least = off;
        best = static_cast<int>(i);
    }
    return best;
}

}  // namespace

LevelChart::LevelChart() {
    setObjectName("level_chart");
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    setAccessibleName(tr("Isovalue on the histogram"));
    setToolTip(
        tr("Histogram of the data (logarithm of the counts).\n"
           "Drag: the isovalue. Arrow keys or wheel after a click: fine steps; Page keys: ten.\n"
           "Squares on the lower edge: levels of layers and of other surfaces, to drag.\n"
           "Points of a curve: drag; double click adds one, right click or Del deletes. By keys:\n"
           "Page keys choose a point, arrows move it, Insert adds one.\n"
           "Ticks on the upper edge: levels that are likely worth feeling.\n"
           "Shift-drag: a new range of interest. Drag the strip below: move or resize it;\n"
           "right click or Del: delete it.\n"
           "Ctrl-wheel zooms, shift-wheel moves, Ctrl+0 shows all again."));
}

void LevelChart::set_data(const run::Histogram& histogram, const std::vector<double>& suggested) {
    histogram_ = histogram;
    suggested_ = suggested;
    view_ = {};
    hold_ = {};
    update();
}

void LevelChart::clear() {
    set_data({}, {});
    bands_.clear();
    marks_.clear();
    set_curve(line_of({}));
    level_shown_ = true;
    felt_ = std::numeric_limits<double>::quiet_NaN();
}

void LevelChart::set_level(double level) {
    if (level == level_) return;
    level_ = level;
    update();
}

void LevelChart::set_felt(double level) {
    if (level == felt_ || (std::isnan(level) && std::isnan(felt_))) return;
    const LevelAxis a = axis();
    const bool seen = std::isnan(level) != std::isnan(felt_) ||
                      std::abs(a.x_of(level) - a.x_of(felt_)) > 0.2 || !std::isfinite(level);
    felt_ = level;
    if (seen) update();
}

void LevelChart::set_bands(const Ranges& bands) {
    if (hold_.part == Part::band) return;
    bands_ = bands;
    if (chosen_ >= static_cast<int>(bands_.size())) chosen_ = -1;
    update();
}

void LevelChart::set_marks(const std::vector<LevelMark>& marks) {
    if (hold_.part == Part::mark || marks == marks_) return;
    marks_ = marks;
    update();
}

void LevelChart::set_level_shown(bool shown) {
    if (shown == level_shown_) return;
    level_shown_ = shown;
    update();
}

void LevelChart::choose_band(int band) {
    if (band == chosen_) return;
    chosen_ = band;
    update();
}

double LevelChart::text_height() const {
    return fontMetrics().height();
}

QRectF LevelChart::plot() const {
    const double tick = 0.5 * text_height();
    return QRectF(rect()).adjusted(6, tick + 2, -6, -(text_height() + tick + 3));
}

QRectF LevelChart::strip() const {
    const QRectF p = plot();
    return {p.left(), p.bottom(), p.width(), 0.5 * text_height()};
}

LevelAxis LevelChart::whole_axis() const {
    return axis_of(histogram_, plot());
}

LevelAxis LevelChart::axis() const {
    return view_.seen(whole_axis());
}

double LevelChart::fine_step() const {
    const LevelAxis a = axis();
    if (histogram_.whole_numbers) return std::max(1.0, std::round((a.high - a.low) / 4096));
    return std::pow(10.0, std::floor(std::log10((a.high - a.low) / 500)));
}

QSize LevelChart::sizeHint() const {
    return {static_cast<int>(18 * text_height()), static_cast<int>(8 * text_height())};
}

QSize LevelChart::minimumSizeHint() const {
    return {static_cast<int>(8 * text_height()), static_cast<int>(8 * text_height())};
}

/// Shows the requested level at once; the owner may set another one.
void LevelChart::ask_level(double level) {
    if (level == level_) return;
    level_ = level;
    update();
    Q_EMIT level_moved(level);
}

void LevelChart::step_level(double steps) {
    if (!level_shown_) return;
    const LevelAxis a = whole_axis();
    const double from = std::isfinite(level_) ? level_ : a.low;
    ask_level(std::clamp(from + steps * fine_step(), a.low, a.high));
}

int LevelChart::knot_at(const QPointF& at) const {
    return curve_.knot_at(at, axis(), plot(), reach + 1);
}

LevelChart::Hold LevelChart::hold_at(const QPointF& at) const {
    const QRectF p = plot();
    if (have_bands() && at.y() >= strip().top()) {
        const BandGrip band = band_at(bands_, axis(), at.x(), reach);
        return {Part::band, band.band, band.grip};
    }
    if (const int knot = knot_at(at); knot >= 0) return {Part::knot, knot};
    if (level_shown_ && at.y() <= p.top() + 1) {
        const int tick = nearest(suggested_, axis(), at.x(), std::identity());
        if (tick >= 0) return {Part::tick, tick};
    }
    const double grips = level_shown_ ? p.bottom() - 0.7 * text_height() : p.top();
    if (at.y() >= grips && at.y() <= p.bottom() + 1) {
        const int mark = nearest(marks_, axis(), at.x(), &LevelMark::level);
        if (mark >= 0) return {Part::mark, mark};
    }
    return {level_shown_ ? Part::level : Part::none};
}

void LevelChart::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton || histogram_.counts.empty()) return;
    const QPointF at = event->localPos();
    pressed_at_ = at;
    held_at_ = axis().round_level_of(at.x());
    if (event->modifiers() & Qt::ShiftModifier) {
        if (level_shown_) hold_ = {Part::fresh};
        fresh_ = {held_at_, held_at_};
        return;
    }
    hold_ = hold_at(at);
    if (hold_.part != Part::band) hold_knot(hold_.part == Part::knot ? hold_.at : -1);
    switch (hold_.part) {
        case Part::tick:
            ask_level(suggested_[static_cast<std::size_t>(hold_.at)]);
            break;
        case Part::mark:
            Q_EMIT mark_chosen(hold_.at);
            break;
        case Part::band:
            choose_band(hold_.at);
            if (hold_.at < 0) {
                hold_ = {};
            } else {
                held_ = bands_[static_cast<std::size_t>(hold_.at)];
            }
            break;
        case Part::level:
            // Pressing on the line itself does not move it.
            if (std::abs(axis().x_of(level_) - at.x()) > 1.5) ask_level(held_at_);
            break;
        default:
            break;
    }
}

void LevelChart::mouseMoveEvent(QMouseEvent* event) {
    const QPointF at = event->localPos();
    if (activates_ && (at - pressed_at_).manhattanLength() <= jitter) return;
    activates_ = false;
    if (hold_.part == Part::none) return show_cursor(at);
    drag_to(at);
}

void LevelChart::drag_to(const QPointF& at) {
    const LevelAxis a = axis();
    const double level = a.round_level_of(at.x());
    const auto held = static_cast<std::size_t>(hold_.at);
    switch (hold_.part) {
        case Part::level:
            return ask_level(level);
        case Part::knot:
            curve_.put(held, curve_.knot_of(at, a, plot()), a.step());
            return curve_edited();
        case Part::mark: {
            LevelMark& mark = marks_[held];
            mark.level = std::clamp(level, mark.low, mark.high);
            update();
            Q_EMIT mark_moved(hold_.at, mark.level);
            return;
        }
        case Part::band: {
            DensityRange& band = bands_[held];
            const DensityRange moved = dragged(held_, hold_.grip, held_at_, level, whole_axis());
            if (moved.low == band.low && moved.high == band.high) return;
            band = moved;
            update();
            Q_EMIT bands_moved(bands_);
            return;
        }
        case Part::fresh:
            fresh_ = {std::min(held_at_, level), std::max(held_at_, level)};
            update();
            return;
        default:
            return;
    }
}

void LevelChart::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton) return;
    const Hold hold = std::exchange(hold_, {});
    update();
    if (hold.part == Part::knot) {
        if (curve_.colours.empty()) set_curve(line_of(curve_.knots, curve_.least, curve_.unit));
        if (std::exchange(activates_, false)) Q_EMIT knot_activated(hold.at);
    }
    if (hold.part == Part::band) Q_EMIT bands_settled();
    // A click makes no range.
    if (hold.part == Part::fresh && fresh_.low < fresh_.high) Q_EMIT band_added(fresh_);
}

void LevelChart::show_cursor(const QPointF& at) {
    const Hold hold = hold_at(at);
    const bool on_line = hold.part == Part::level && std::abs(axis().x_of(level_) - at.x()) < reach;
    setCursor(hold.grip == Grip::whole             ? Qt::OpenHandCursor
              : hold.grip != Grip::none            ? Qt::SizeHorCursor
              : hold.part == Part::knot            ? Qt::SizeAllCursor
              : on_line || hold.part == Part::mark ? Qt::SplitHCursor
                                                   : Qt::ArrowCursor);
}

void LevelChart::contextMenuEvent(QContextMenuEvent* event) {
    const QPointF at = event->pos();
    if (const int knot = knot_at(at); knot >= 0) return remove_knot(knot);
    const int band = band_at(bands_, axis(), at.x(), reach).band;
    if (!have_bands() || band < 0) return;
    choose_band(band);
    auto* menu = new QMenu(this);
    menu->setAttribute(Qt::WA_DeleteOnClose);
    const DensityRange& range = bands_[static_cast<std::size_t>(band)];
    menu->addAction(
        tr("Delete range %1 to %2").arg(number_text(range.low), number_text(range.high)), this,
        [this, band] { Q_EMIT band_deleted(band); });
    menu->popup(event->globalPos());  // does not block the window
}

void LevelChart::keyPressEvent(QKeyEvent* event) {
    if (histogram_.counts.empty()) return QWidget::keyPressEvent(event);
    const double many = event->modifiers() & Qt::ShiftModifier ? 10 : 1;
    if (!level_shown_ && step_knot(event->key(), many)) return;
    const std::map<int, double> steps{{Qt::Key_Left, -many},   {Qt::Key_Down, -many},
                                      {Qt::Key_Right, many},   {Qt::Key_Up, many},
                                      {Qt::Key_PageDown, -10}, {Qt::Key_PageUp, 10}};
    const auto step = steps.find(event->key());
    if (step != steps.end()) return step_level(step->second);
    switch (event->key()) {
        case Qt::Key_Home:
            if (level_shown_) ask_level(whole_axis().low);
            break;
        case Qt::Key_End:
            if (level_shown_) ask_level(whole_axis().high);
            break;
        case Qt::Key_0:
            if (!(event->modifiers() & Qt::ControlModifier)) return event->ignore();
            view_ = {};
            update();
            break;
        case Qt::Key_Delete:
        case Qt::Key_Backspace:
            if (held_knot_ >= 0) return remove_knot(held_knot_);
            if (have_bands() && chosen_ >= 0) Q_EMIT band_deleted(chosen_);
            break;
        default:
            QWidget::keyPressEvent(event);
    }
}

void LevelChart::wheelEvent(QWheelEvent* event) {
    if (histogram_.counts.empty()) return event->ignore();
    if (view_.wheel(*event, whole_axis())) {
        event->accept();
        update();
        return;
    }
    if (!hasFocus()) return event->ignore();
    event->accept();
    wheel_ += event->angleDelta().y();
    const int steps = wheel_ / 120;  // touch pads send parts of a step
    wheel_ -= 120 * steps;
    if (steps != 0) step_level(steps);
}

}  // namespace palpate::viewer
