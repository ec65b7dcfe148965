// Input of the level chart.
#include "apps/viewer/panel/level_chart.hpp"

#include <QContextMenuEvent>
#include <QKeyEvent>
#include <QMenu>
#include <QMouseEvent>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/inputs.hpp"

namespace palpate::viewer {
namespace {

constexpr double reach = 5;  // [logical pixels] distance within which the pointer takes hold

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
    drag_ = Drag::none;
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
    if (drag_ == Drag::band) return;
    bands_ = bands;
    if (chosen_ >= static_cast<int>(bands_.size())) chosen_ = -1;
    update();
}

void LevelChart::set_marks(const std::vector<LevelMark>& marks) {
    if (drag_ == Drag::mark || marks == marks_) return;
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

/// The suggested level whose tick is under the pointer, or -1.
int LevelChart::tick_at(const QPointF& at) const {
    if (at.y() > plot().top() + 1) return -1;
    int best = -1;
    double nearest = reach + 1;
    for (std::size_t i = 0; i < suggested_.size(); ++i) {
        const double off = std::abs(axis().x_of(suggested_[i]) - at.x());
        if (off >= nearest) continue;
        nearest = off;
        best = static_cast<int>(i);
    }
    return best;
}

/// The mark whose grip is under the pointer, or -1.
int LevelChart::mark_at(const QPointF& at) const {
    const double top = level_shown_ ? plot().bottom() - 0.7 * text_height() : plot().top();
    if (at.y() < top || at.y() > plot().bottom() + 1) return -1;
    int best = -1;
    double nearest = reach + 1;
    for (std::size_t i = 0; i < marks_.size(); ++i) {
        const double off = std::abs(axis().x_of(marks_[i].level) - at.x());
        if (off >= nearest) continue;
        nearest = off;
        best = static_cast<int>(i);
    }
    return best;
}

void LevelChart::press_strip(const QPointF& at) {
    grip_ = band_at(bands_, axis(), at.x(), reach);
    if (!editable_ && grip_.grip == Grip::whole) grip_ = {};
    chosen_ = grip_.band;
    Q_EMIT band_chosen(chosen_);
    if (grip_.band >= 0) {
        drag_ = Drag::band;
        held_ = bands_[static_cast<std::size_t>(grip_.band)];
        held_at_ = axis().round_level_of(at.x());
    }
    update();
}

void LevelChart::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton || histogram_.counts.empty()) return;
    const QPointF at = event->localPos();
    if (event->modifiers() & Qt::ShiftModifier) {
        if (!level_shown_) return;
        drag_ = Drag::fresh;
        held_at_ = axis().round_level_of(at.x());
        fresh_ = {held_at_, held_at_};
        return;
    }
    if (have_bands() && at.y() >= strip().top()) {
        press_strip(at);
        return;
    }
    hold_knot(knot_at(at));
    if (held_knot_ >= 0) {
        drag_ = Drag::knot;
        return;
    }
    if (const int tick = tick_at(at); tick >= 0 && level_shown_) {
        ask_level(suggested_[static_cast<std::size_t>(tick)]);
        Q_EMIT level_settled();
        return;
    }
    held_mark_ = mark_at(at);
    if (held_mark_ >= 0) {
        drag_ = Drag::mark;
        Q_EMIT mark_chosen(held_mark_);
        return;
    }
    if (!level_shown_) return;
    drag_ = Drag::level;
    // Pressing on the line itself does not move it.
    if (std::abs(axis().x_of(level_) - at.x()) > 1.5) ask_level(axis().round_level_of(at.x()));
}

void LevelChart::mouseMoveEvent(QMouseEvent* event) {
    const LevelAxis a = axis();
    const double level = a.round_level_of(event->localPos().x());
    switch (drag_) {
        case Drag::none:
            show_cursor(event->localPos());
            return;
        case Drag::level:
            ask_level(level);
            return;
        case Drag::knot:
            curve_.put(static_cast<std::size_t>(held_knot_),
                       curve_.knot_of(event->localPos(), a, plot()), a.step());
            return curve_edited();
        case Drag::mark: {
            LevelMark& mark = marks_[static_cast<std::size_t>(held_mark_)];
            mark.level = std::clamp(level, mark.low, mark.high);
            update();
            Q_EMIT mark_moved(held_mark_, mark.level);
            return;
        }
        case Drag::band: {
            DensityRange& band = bands_[static_cast<std::size_t>(grip_.band)];
            const DensityRange moved = dragged(held_, grip_.grip, held_at_, level, whole_axis());
            if (moved.low == band.low && moved.high == band.high) return;
            band = moved;
            update();
            Q_EMIT bands_moved(bands_);
            return;
        }
        case Drag::fresh:
            fresh_ = {std::min(held_at_, level), std::max(held_at_, level)};
            update();
            return;
    }
}

void LevelChart::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton) return;
    const Drag drag = std::exchange(drag_, Drag::none);
    update();
    if (drag == Drag::knot) {
        if (curve_.colours.empty()) set_curve(line_of(curve_.knots, curve_.least, curve_.unit));
        Q_EMIT curve_settled();
    }
    if (drag == Drag::level) Q_EMIT level_settled();
    if (drag == Drag::band) Q_EMIT bands_settled();
    // A click makes no range.
    if (drag == Drag::fresh && fresh_.low < fresh_.high) Q_EMIT band_added(fresh_);
}

void LevelChart::show_cursor(const QPointF& at) {
    Qt::CursorShape shape = Qt::ArrowCursor;
    if (have_bands() && at.y() >= strip().top()) {
        const Grip grip = band_at(bands_, axis(), at.x(), reach).grip;
        if (grip == Grip::low || grip == Grip::high) shape = Qt::SizeHorCursor;
        if (grip == Grip::whole && editable_) shape = Qt::OpenHandCursor;
    } else if (knot_at(at) >= 0) {
        shape = Qt::SizeAllCursor;
    } else if ((level_shown_ && std::abs(axis().x_of(level_) - at.x()) < reach) ||
               mark_at(at) >= 0) {
        shape = Qt::SplitHCursor;
    }
    setCursor(shape);
}

void LevelChart::contextMenuEvent(QContextMenuEvent* event) {
    const QPointF at = event->pos();
    if (const int knot = knot_at(at); knot >= 0) {
        return remove_knot(knot);
    }
    const int band = band_at(bands_, axis(), at.x(), reach).band;
    if (!editable_ || !have_bands() || band < 0) return;
    choose_band(band);
    Q_EMIT band_chosen(band);
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
    switch (event->key()) {
        case Qt::Key_Left:
        case Qt::Key_Down:
            step_level(-many);
            break;
        case Qt::Key_Right:
        case Qt::Key_Up:
            step_level(many);
            break;
        case Qt::Key_PageDown:
            step_level(-10);
            break;
        case Qt::Key_PageUp:
            step_level(10);
            break;
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
            if (editable_ && have_bands() && chosen_ >= 0) Q_EMIT band_deleted(chosen_);
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
