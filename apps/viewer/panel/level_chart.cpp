// Input of the level chart.
#include "apps/viewer/panel/level_chart.hpp"

#include <QContextMenuEvent>
#include <QKeyEvent>
#include <QMenu>
#include <QMouseEvent>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "apps/viewer/panel/inputs.hpp"

namespace palpate::viewer {
namespace {

constexpr double reach = 5;  // [logical pixels] distance within which the pointer takes hold
constexpr int jitter = 3;    // [logical pixels] of a pointer that clicks
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The number of the least of so many distances that is below `within`, or -1.
int nearest(std::size_t count, double within, auto distance) {
    int best = -1;
    for (std::size_t i = 0; i < count; ++i) {
        const double away = distance(i);
        if (!(away < within)) continue;
        within = away;
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
    hold_.reset();
    new_band_.reset();
    update();
}

void LevelChart::set_level(double level) {
    level_ = level;
    update();
}

/// Thirty times a second: draws only what can be seen.
void LevelChart::set_felt(double level) {
    if (level == felt_ || (std::isnan(level) && std::isnan(felt_))) return;
    const LevelAxis a = axis();
    const bool moved = !(std::abs(a.x_of(level) - a.x_of(felt_)) <= 0.2);
    if (moved || !std::isfinite(level)) update();
    felt_ = level;
}

void LevelChart::set_bands(const Ranges& bands) {
    bands_ = bands;
    if (band_ >= static_cast<int>(bands_.size())) band_ = -1;
    update();
}

void LevelChart::set_marks(std::vector<LevelMark> marks) {
    marks_ = std::move(marks);
    update();
}

void LevelChart::set_curve(const CurveLine& curve) {
    const double top = curve_.top;
    curve_ = curve;
    curve_.fit();
    if (hold_) curve_.top = top;
    if (knot_ >= static_cast<int>(curve.knots.size())) knot_ = -1;
    update();
}

bool LevelChart::have_level() const {
    return !std::isnan(level_);
}

void LevelChart::choose(int knot, int band) {
    knot_ = knot < static_cast<int>(curve_.knots.size()) ? knot : -1;
    band_ = band;
    update();
    Q_EMIT knot_held(knot_);
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
    return {static_cast<int>(8 * text_height()), static_cast<int>(5 * text_height())};
}

void LevelChart::ask_level(double level) {
    if (level != level_) Q_EMIT level_moved(level);
}

void LevelChart::step_level(double steps) {
    const LevelAxis a = whole_axis();
    const double from = std::isfinite(level_) ? level_ : a.low;
    ask_level(std::clamp(from + steps * fine_step(), a.low, a.high));
}

QPointF LevelChart::place_of(std::size_t knot) const {
    const auto [level, value] = curve_.knots.at(knot);
    const double part = std::clamp(value / curve_.top, 0.0, 1.0);
    return {axis().x_of(level), plot().bottom() - part * plot().height()};
}

Curve::Knot LevelChart::knot_of(const QPointF& at) const {
    const QRectF p = plot();
    const double part = std::clamp((p.bottom() - at.y()) / p.height(), 0.0, 1.0);
    const double digit = std::pow(10.0, std::floor(std::log10(curve_.top)) - 2);  // short numbers
    return {axis().round_level_of(at.x()), std::round(part * curve_.top / digit) * digit};
}

void LevelChart::ask_curve(const CurveLine& curve, int chosen) {
    Q_EMIT curve_changed(curve.knots, curve.colours);
    choose(chosen, -1);
}

void LevelChart::put_knot(int knot, const Curve::Knot& to) {
    CurveLine next = curve_;
    if (knot < 0 || knot >= static_cast<int>(next.knots.size())) return;
    next.put(static_cast<std::size_t>(knot), to, axis().step());
    ask_curve(next, knot);
}

void LevelChart::add_knot(const QPointF& at) {
    CurveLine next = curve_;
    if (const int added = next.add(knot_of(at)); added >= 0) ask_curve(next, added);
}

/// The last ones stay, because a curve needs knots.
void LevelChart::remove_knot(int knot) {
    CurveLine next = curve_;
    if (next.remove(knot)) ask_curve(next, -1);
}

int LevelChart::knot_at(const QPointF& at) const {
    return nearest(curve_.knots.size(), reach + 1, [&](std::size_t i) {
        const QPointF away = place_of(i) - at;
        return std::hypot(away.x(), away.y());
    });
}

LevelChart::Handle LevelChart::handle_at(const QPointF& at) {
    const LevelAxis a = axis();
    const QRectF p = plot();
    const auto away = [&](double level) { return std::abs(a.x_of(level) - at.x()); };
    if (have_level() && !bands_.empty() && at.y() >= strip().top()) return band_handle(at.x());
    if (const int knot = knot_at(at); knot >= 0) return knot_handle(knot);
    if (have_level() && at.y() <= p.top() + 1) {
        const int tick = nearest(suggested_.size(), reach + 1,
                                 [&](std::size_t i) { return away(suggested_[i]); });
        if (tick >= 0) {
            return {.press = [this, to = suggested_[std::size_t(tick)]] { ask_level(to); }};
        }
    }
    const double grips = have_level() ? p.bottom() - 0.7 * text_height() : p.top();
    const int mark =
        nearest(marks_.size(), reach + 1, [&](std::size_t i) { return away(marks_[i].level); });
    if (mark >= 0 && at.y() >= grips && at.y() <= p.bottom() + 1) {
        const LevelMark held = marks_[std::size_t(mark)];
        return {.cursor = Qt::SplitHCursor, .press = held.pressed, .drag = [=, this](QPointF to) {
                    held.moved(std::clamp(axis().round_level_of(to.x()), held.low, held.high));
                }};
    }
    if (!have_level()) return {};
    const auto follow = [this](const QPointF& to) { ask_level(axis().round_level_of(to.x())); };
    // Pressing on the line itself does not move it.
    return {.cursor = away(level_) < reach ? Qt::SplitHCursor : Qt::ArrowCursor,
            .press =
                [=, on_line = away(level_) <= 1.5] {
                    if (!on_line) follow(at);
                },
            .drag = follow};
}

LevelChart::Handle LevelChart::knot_handle(int knot) {
    return {.cursor = Qt::SizeAllCursor,
            .drag = [=, this](const QPointF& to) { put_knot(knot, knot_of(to)); },
            .release =
                [=, this] {
                    curve_.fit();
                    if (std::exchange(activates_, false)) Q_EMIT knot_activated(knot);
                },
            .knot = knot};
}

/// The nearest end within reach, else the band itself.
LevelChart::Handle LevelChart::band_handle(double x) {
    const LevelAxis a = axis();
    const int end = nearest(2 * bands_.size(), reach, [&](std::size_t i) {
        const bool low = i % 2 == 0;
        const double level = low ? bands_[i / 2].low : bands_[i / 2].high, at = a.x_of(level);
        // Of equal ends, takes the one on the pointer's side, so that a closed band can open.
        const bool outside = low ? x < at : x > at;
        return std::isfinite(level) ? std::abs(x - at) - (outside ? 0.01 : 0) : infinity;
    });
    const auto over = std::ranges::find_if(bands_, [&](const DensityRange& band) {
        return x > a.x_of(band.low) && x < a.x_of(band.high);
    });
    if (end < 0 && over == bands_.end()) return {};
    const auto at = static_cast<std::size_t>(end < 0 ? over - bands_.begin() : end / 2);
    const Grip grip = end < 0 ? Grip::whole : end % 2 == 0 ? Grip::low : Grip::high;
    const auto drag = [=, this, start = bands_[at], held = a.round_level_of(x)](const QPointF& to) {
        if (at >= bands_.size()) return;
        Ranges moved = bands_;
        moved[at] = dragged(start, grip, held, axis().round_level_of(to.x()), whole_axis());
        if (moved[at].low == bands_[at].low && moved[at].high == bands_[at].high) return;
        Q_EMIT bands_moved(moved);
    };
    return {.cursor = grip == Grip::whole ? Qt::OpenHandCursor : Qt::SizeHorCursor,
            .drag = drag,
            .release = [this] { Q_EMIT bands_settled(); },
            .band = static_cast<int>(at)};
}

LevelChart::Handle LevelChart::new_band_handle(double x) {
    const double held = axis().round_level_of(x);
    return {
        .drag =
            [=, this](const QPointF& to) {
                const double level = axis().round_level_of(to.x());
                new_band_ = {std::min(held, level), std::max(held, level)};
                update();
            },
        .release =
            [this] {
                const DensityRange made = std::exchange(new_band_, {}).value_or(DensityRange{0, 0});
                if (made.low < made.high) Q_EMIT band_added(made);  // a click makes none
            }};
}

void LevelChart::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton || histogram_.counts.empty()) return;
    pressed_at_ = event->localPos();
    const bool makes_band = event->modifiers() & Qt::ShiftModifier;
    const Handle held = !makes_band    ? handle_at(pressed_at_)
                        : have_level() ? new_band_handle(pressed_at_.x())
                                       : Handle();
    hold_ = held;
    choose(held.knot, held.band);
    held.press();
}

void LevelChart::mouseMoveEvent(QMouseEvent* event) {
    const QPointF at = event->localPos();
    if (activates_ && (at - pressed_at_).manhattanLength() <= jitter) return;
    activates_ = false;
    if (!hold_) return setCursor(handle_at(at).cursor);
    const Handle held = *hold_;  // other data may come by what it does
    held.drag(at);
}

void LevelChart::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton || !hold_) return;
    const Handle held = *std::exchange(hold_, std::nullopt);
    held.release();
    update();
}

/// A second press holds a knot, too, and what there is to do with it is done if it is not dragged.
/// Elsewhere it makes another knot, which it holds.
void LevelChart::mouseDoubleClickEvent(QMouseEvent* event) {
    const QPointF at = event->localPos();
    const bool on_curve = event->button() == Qt::LeftButton && !curve_.knots.empty();
    const bool on_knot = on_curve && handle_at(at).knot >= 0;
    if (on_curve && !on_knot && plot().contains(at)) {
        hold_.emplace();  // the scale stays, so that the knot is where the pointer is
        add_knot(at);
    }
    mousePressEvent(event);
    activates_ = on_knot;
}

void LevelChart::contextMenuEvent(QContextMenuEvent* event) {
    const QPointF at = event->pos();
    if (const int knot = knot_at(at); knot >= 0) return remove_knot(knot);
    const int band = have_level() ? band_handle(at.x()).band : -1;
    if (band < 0) return;
    choose(-1, band);
    auto* menu = new QMenu(this);
    menu->setAttribute(Qt::WA_DeleteOnClose);
    const DensityRange& range = bands_[static_cast<std::size_t>(band)];
    menu->addAction(
        tr("Delete range %1 to %2").arg(number_text(range.low), number_text(range.high)), this,
        [this, band] { Q_EMIT band_deleted(band); });
    menu->popup(event->globalPos());  // does not block the window
}

void LevelChart::keyPressEvent(QKeyEvent* event) {
    const int key = event->key();
    const double many = event->modifiers() & Qt::ShiftModifier ? 10 : 1;
    if (histogram_.counts.empty()) return QWidget::keyPressEvent(event);
    if (key == Qt::Key_0 && event->modifiers() & Qt::ControlModifier) {
        view_ = {};
        return update();
    }
    if (key == Qt::Key_Delete || key == Qt::Key_Backspace) {
        if (have_level() && band_ >= 0) Q_EMIT band_deleted(band_);
        return remove_knot(knot_);
    }
    const bool taken = have_level() ? level_key(key, many) : knot_key(key, many);
    if (!taken) QWidget::keyPressEvent(event);
}

/// False: the key is for something else.
bool LevelChart::level_key(int key, double many) {
    const std::map<int, double> steps{{Qt::Key_Left, -many},     {Qt::Key_Down, -many},
                                      {Qt::Key_Right, many},     {Qt::Key_Up, many},
                                      {Qt::Key_PageDown, -10},   {Qt::Key_PageUp, 10},
                                      {Qt::Key_Home, -infinity}, {Qt::Key_End, infinity}};
    const auto step = steps.find(key);
    if (step == steps.end()) return false;
    step_level(step->second);
    return true;
}

/// Moves the chosen knot, or chooses another.
bool LevelChart::knot_key(int key, double many) {
    const int count = static_cast<int>(curve_.knots.size());
    // A pixel is the finest that dragging has.
    const std::map<int, QPointF> ways{{Qt::Key_Left, {-many, 0}},
                                      {Qt::Key_Right, {many, 0}},
                                      {Qt::Key_Up, {0, -many}},
                                      {Qt::Key_Down, {0, many}}};
    const auto way = ways.find(key);
    const int by = key == Qt::Key_PageDown ? 1 : key == Qt::Key_PageUp ? -1 : 0;
    if (count > 0 && (by != 0 || (knot_ < 0 && way != ways.end()))) {
        choose(knot_ < 0 ? 0 : std::clamp(knot_ + by, 0, count - 1), -1);
        return true;
    }
    if (knot_ < 0) return false;
    const auto held = static_cast<std::size_t>(knot_);
    const QPointF at = place_of(held);
    if (way != ways.end()) {
        put_knot(knot_, knot_of(at + way->second));
    } else if (key == Qt::Key_Insert) {
        // In the middle to the next one, or to the edge.
        const bool last = knot_ + 1 == count;
        add_knot(0.5 * (at + (last ? QPointF(plot().right(), at.y()) : place_of(held + 1))));
    } else if (key == Qt::Key_Return || key == Qt::Key_Enter) {
        Q_EMIT knot_activated(knot_);
    } else {
        return false;
    }
    return true;
}

void LevelChart::wheelEvent(QWheelEvent* event) {
    const QPoint turned = event->angleDelta();
    const double notches = (turned.x() + turned.y()) / 120.0;
    if (histogram_.counts.empty()) return event->ignore();
    if (event->modifiers() & Qt::ControlModifier) {
        const LevelAxis all = whole_axis();
        const double level = axis().level_of(event->position().x());
        view_.zoom(std::pow(1.25, notches), (level - all.low) / (all.high - all.low));
    } else if (event->modifiers() & Qt::ShiftModifier) {
        view_.move(-0.1 * notches);
    } else if (hasFocus()) {
        wheel_ += turned.y();
        const int steps = wheel_ / 120;  // touch pads send parts of a step
        wheel_ -= 120 * steps;
        if (steps != 0 && have_level()) step_level(steps);
    } else {
        return event->ignore();
    }
    event->accept();
    update();
}

}  // namespace palpate::viewer
