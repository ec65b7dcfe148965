// Times, frames and texts of a timeline, its track and its controls: shows views, emits the actions
// of the user.
#include "apps/viewer/panel/timeline.hpp"

#include <QBoxLayout>
#include <QCheckBox>
#include <QCoreApplication>
#include <QHelpEvent>
#include <QKeyEvent>
#include <QLabel>
#include <QMouseEvent>
#include <QPainter>
#include <QSignalBlocker>
#include <QToolButton>
#include <QToolTip>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {
namespace {

struct TimelineWords {
    Q_DECLARE_TR_FUNCTIONS(TimelineWords)
};

constexpr double recording_step = 0.01;  // [s]

/// Digits behind the point that tell one frame from the next, at least two.
int digits_for(const TimelineView& view) {
    if (view.frames.size() < 2) return 2;
    const double apart =
        (view.frames.back() - view.frames.front()) / static_cast<double>(view.frames.size() - 1);
    if (!(apart > 0)) return 2;
    return std::clamp(1 - static_cast<int>(std::floor(std::log10(apart))), 2, 9);
}

/// "1:02.345"; hours where there are any.
QString clock_text(double seconds) {
    const auto all = static_cast<long long>(std::floor(1e3 * seconds + 0.5));
    const long long minutes = all / 60000 % 60, hours = all / 3600000;
    const QString rest =
        QString("%1.%2").arg(all / 1000 % 60, 2, 10, QChar('0')).arg(all % 1000, 3, 10, QChar('0'));
    return hours > 0 ? QString("%1:%2:%3").arg(hours).arg(minutes, 2, 10, QChar('0')).arg(rest)
                     : QString("%1:%2").arg(minutes).arg(rest);
}

/// By how much a time may miss a frame's and still be that frame's: rounding.
double rounding(const TimelineView& view) {
    return 1e-9 * std::max({length(view), std::abs(view.begin), std::abs(view.end)});
}

}  // namespace

void TimelineView::play(double to) {
    if (speed == 0 && to != 0 && time >= end) time = begin;
    speed = to;
}

void TimelineView::advance(double seconds) {
    time += speed * seconds;
    if (time < end || speed == 0) return;
    if (loop && end > begin) {
        time = begin + std::fmod(time - begin, end - begin);
    } else {
        time = end;
        speed = 0;
    }
}

bool empty(const TimelineView& view) {
    return view.frames.empty() && !view.live && !view.overview;
}

double length(const TimelineView& view) {
    return std::max(view.end - view.begin, 0.0);
}

double within(const TimelineView& view, double time) {
    if (std::isnan(time)) return view.begin;
    if (time >= view.begin && time <= view.end) return time;
    if (!view.loop || length(view) == 0 || std::isinf(time)) {
        return time < view.begin ? view.begin : std::max(view.begin, view.end);
    }
    const double round = std::fmod(time - view.begin, length(view));
    return view.begin + (round < 0 ? round + length(view) : round);
}

std::optional<std::size_t> frame_at(const TimelineView& view, double time) {
    if (view.frames.empty()) return std::nullopt;
    const auto after = std::ranges::upper_bound(view.frames, time + rounding(view));
    return after == view.frames.begin() ? 0
                                        : static_cast<std::size_t>(after - view.frames.begin()) - 1;
}

std::optional<double> frame_beside(const TimelineView& view, double time, int direction) {
    const std::vector<double>& frames = view.frames;
    if (view.overview) {
        const double to = time + (direction > 0 ? recording_step : -recording_step);
        return std::clamp(to, view.begin, view.end);
    }
    if (frames.empty()) return std::nullopt;
    const bool round = view.loop && frames.size() > 1;
    if (direction > 0) {
        const auto after = std::ranges::upper_bound(frames, time + rounding(view));
        if (after != frames.end()) return *after;
        return round ? std::optional(frames.front()) : std::nullopt;
    }
    const auto from = std::ranges::lower_bound(frames, time - rounding(view));
    if (from != frames.begin()) return *(from - 1);
    return round ? std::optional(frames.back()) : std::nullopt;
}

QString text_at(const TimelineView& view, double time) {
    if (view.overview) {
        return clock_text(time - view.begin) + " / " + clock_text(view.end - view.begin);
    }
    const QString seconds = QString("%1 s").arg(time, 0, 'f', digits_for(view));
    if (view.live) return TimelineWords::tr("%1, live").arg(seconds);
    const auto frame = frame_at(view, time);
    if (!frame) return {};
    return TimelineWords::tr("%1, frame %2 of %3")
        .arg(seconds)
        .arg(*frame + 1)
        .arg(view.frames.size());
}

QString overview_text_at(const TimelineView& view, double time) {
    QString words = QString("%1 s").arg(time - view.begin, 0, 'f', 3);
    const Overview::Piece piece = view.overview->over(time, time);
    if (piece.empty) return words;
    words += "\n" + TimelineWords::tr("force up to %1 N").arg(piece.most_force, 0, 'f', 2);
    if (piece.least_isovalue <= piece.most_isovalue) {
        words += "\n" + TimelineWords::tr("isovalue %1").arg(piece.most_isovalue, 0, 'g', 6);
    }
    if (piece.contact) words += "\n" + TimelineWords::tr("in contact");
    return words;
}

std::vector<Stretch> loaded_stretches(const TimelineView& view) {
    const double from = view.loaded_from, whole = length(view);
    double to = view.loaded_to;
    if (view.loop) to = std::min(to < from ? to + whole : to, from + whole);
    if (!std::isfinite(from) || !(from <= to)) return {};
    std::vector<Stretch> stretches;
    // In a loop also a length earlier and later, of which only one can reach in.
    for (const double shift : {-whole, 0.0, whole}) {
        if (shift != 0 && !view.loop) continue;
        const double low = std::max(from + shift, view.begin);
        const double high = std::min(to + shift, view.end);
        if (low < high || (low == high && from == to)) stretches.push_back({low, high});
    }
    return stretches;
}

TimelineTrack::TimelineTrack() {
    setObjectName("timeline_track");
    setAccessibleName(tr("Time [ms]"));
    setAccessibleDescription(tr("Arrows go from frame to frame"));
    setFocusPolicy(Qt::StrongFocus);
    setOrientation(Qt::Horizontal);
    // By keys, and by whatever else moves a slider.
    connect(this, &QAbstractSlider::valueChanged, this, [this](int milliseconds) {
        choose(std::min(view_.begin + 1e-3 * milliseconds, view_.end));
    });
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

bool TimelineTrack::set_view(const TimelineView& view) {
    const auto what = [](const TimelineView& v) {
        return std::tie(v.begin, v.end, v.live, v.frames, v.overview);
    };
    const auto state = [](const TimelineView& v) {
        return std::tie(v.loop, v.loaded_from, v.loaded_to);
    };
    const bool other = what(view) != what(view_);
    if (!other && state(view) == state(view_)) return false;
    view_ = view;
    update();
    if (!other) return false;
    const QSignalBlocker quiet(this);  // a drag that ends by this asks for nothing
    setRange(0, static_cast<int>(std::min(std::ceil(1e3 * length(view)), 2e9)));
    setSingleStep(std::max(1, maximum() / 100));
    setPageStep(std::max(1, maximum() / 10));
    setEnabled(!view.live && length(view) > 0);
    updateGeometry();
    set_time(time_);
    return true;
}

void TimelineTrack::set_time(double time) {
    const double to = within(view_, time);
    const QSignalBlocker quiet(this);
    setValue(static_cast<int>(std::lround(std::min(1e3 * (to - view_.begin), 2e9))));
    if (to != std::exchange(time_, to)) update();
}

void TimelineTrack::choose(double time) {
    set_time(time);
    Q_EMIT chosen(time_);
}

QSize TimelineTrack::sizeHint() const {
    return {24 * fontMetrics().height(), (view_.overview ? 3 : 2) * fontMetrics().height()};
}

QSize TimelineTrack::minimumSizeHint() const {
    return {6 * fontMetrics().height(), 2 * fontMetrics().height()};
}

QRectF TimelineTrack::plot() const {
    const double edge = 0.4 * fontMetrics().height();
    return QRectF(rect()).adjusted(edge, 2, -edge, -2);
}

LevelAxis TimelineTrack::axis() const {
    const QRectF box = plot();
    return {view_.begin, view_.begin + length(view_), box.left(),
            std::max(box.right(), box.left() + 1)};
}

bool TimelineTrack::event(QEvent* event) {
    if (event->type() == QEvent::ToolTip && !empty(view_) && !view_.live) {
        const auto* const help = static_cast<QHelpEvent*>(event);
        const double time = axis().level_of(help->pos().x());
        QToolTip::showText(help->globalPos(),
                           view_.overview ? overview_text_at(view_, time) : text_at(view_, time));
        return true;
    }
    return QAbstractSlider::event(event);
}

/// Paints the frames in memory, and a line for each frame, or for fewer if lines would touch.
void TimelineTrack::paint_frames(QPainter& painter) const {
    constexpr double least_between = 3;  // pixels
    const QRectF box = plot();
    const LevelAxis a = axis();
    QColor loaded = palette().color(QPalette::Highlight), lines = palette().color(QPalette::Text);
    loaded.setAlphaF(0.4);
    lines.setAlphaF(0.6);
    for (const auto& [from, to] : loaded_stretches(view_)) {
        const double left = a.x_of(from), width = std::max(a.x_of(to) - left, 2.0);
        painter.fillRect(QRectF(left, box.top(), width, box.height()), loaded);
    }
    painter.setPen(QPen(lines, 1));
    double last = -std::numeric_limits<double>::infinity();
    for (const double frame : view_.frames) {
        const double x = a.x_of(frame);
        if (x - last < least_between) continue;
        painter.drawLine(QPointF(x, box.bottom() - 0.4 * box.height()), QPointF(x, box.bottom()));
        last = x;
    }
}

/// Force, level and contact, one column of pixels at a time.
void TimelineTrack::paint_overview(QPainter& painter) const {
    const Overview& overview = *view_.overview;
    const Overview::Piece whole = overview.over(view_.begin, view_.end);
    const QRectF box = plot();
    const double bar = std::max(3.0, 0.15 * box.height()), bottom = box.bottom() - bar - 2;
    const double step = 1 / devicePixelRatioF();
    const LevelAxis times = axis(), newton{0, whole.most_force, bottom, box.top() + 2},
                    levels{whole.least_isovalue, whole.most_isovalue, bottom - 1, box.top() + 3};
    QColor force = to_qt(pictures::force_colour);
    force.setAlphaF(0.55);
    for (double x = box.left(); x < box.right(); x += step) {
        const auto piece = overview.over(times.level_of(x), times.level_of(x + step));
        const auto fill = [&](double top, double below, const QColor& colour) {
            painter.fillRect(QRectF(x, top, step, below - top), colour);
        };
        fill(newton.x_of(piece.most_force), bottom, force);
        fill(newton.x_of(piece.least_force), bottom, force);
        if (levels.low < levels.high && piece.least_isovalue <= piece.most_isovalue) {
            fill(levels.x_of(piece.most_isovalue) - 0.75, levels.x_of(piece.least_isovalue) + 0.75,
                 palette().color(QPalette::Text));
        }
        if (piece.contact) fill(box.bottom() - bar, box.bottom(), to_qt(pictures::scp_colour));
    }
}

void TimelineTrack::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const QRectF box = plot();
    const QPalette colours = palette();
    painter.fillRect(box, colours.base());
    if (view_.overview) {
        paint_overview(painter);
    } else if (!view_.live) {
        paint_frames(painter);
    }
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(
        QPen(hasFocus() ? colours.highlight().color() : colours.mid().color(), hasFocus() ? 2 : 1));
    painter.drawRect(box);
    if (!isEnabled()) return;
    const double x = axis().x_of(time_), head = 0.35 * fontMetrics().height();
    const QBrush& marker = view_.overview ? colours.highlight() : colours.text();
    painter.setPen(QPen(marker.color(), 2));
    painter.drawLine(QPointF(x, box.top()), QPointF(x, box.bottom()));
    painter.setPen(QPen(colours.base().color(), 1));
    painter.setBrush(marker);
    painter.drawPolygon(QPolygonF({QPointF(x - head, box.top()), QPointF(x + head, box.top()),
                                   QPointF(x, box.top() + 1.6 * head)}));
}

void TimelineTrack::keyPressEvent(QKeyEvent* event) {
    switch (event->key()) {
        case Qt::Key_Right:
        case Qt::Key_Up:
            Q_EMIT stepped(1);
            return;
        case Qt::Key_Left:
        case Qt::Key_Down:
            Q_EMIT stepped(-1);
            return;
        default:
            QAbstractSlider::keyPressEvent(event);
    }
}

void TimelineTrack::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton) return event->ignore();
    setSliderDown(true);
    choose(axis().level_of(event->localPos().x()));
}

void TimelineTrack::mouseMoveEvent(QMouseEvent* event) {
    if (isSliderDown()) choose(axis().level_of(event->localPos().x()));
}

void TimelineTrack::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() == Qt::LeftButton) setSliderDown(false);
}

namespace {

constexpr std::array speed_steps{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0};  // of the speed

/// Any speed; steps go to the usual ones.
class SpeedBox : public NumberBox {
  public:
    void stepBy(int count) override {
        const auto* const from = count > 0 ? std::ranges::upper_bound(speed_steps, value())
                                           : std::ranges::lower_bound(speed_steps, value());
        const auto to = from - speed_steps.begin() + (count > 0 ? count - 1 : count);
        constexpr auto last = static_cast<std::ptrdiff_t>(speed_steps.size()) - 1;
        setValue(speed_steps[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(to, 0, last))]);
        selectAll();
    }
};

QToolButton* make_button(const QString& name, const QString& accessible, const QString& tip) {
    auto* button = named(new QToolButton, name, tip);
    button->setAutoRaise(true);
    button->setAccessibleName(accessible);
    return button;
}

}  // namespace

Timeline::Timeline(QWidget* parent)
    : QWidget(parent),
      back_(make_button("timeline_back", tr("Step back"), tr("To the frame before"))),
      play_(make_button("timeline_play", {}, {})),
      forward_(make_button("timeline_forward", tr("Step forward"), tr("To the next frame"))),
      track_(new TimelineTrack),
      text_(
          named(new QLabel, "timeline_time",
                tr("The time shown [s] or [minutes:seconds], and the frame there or the length"))),
      speed_(named(new SpeedBox, "timeline_speed", tr("Seconds played in a second, 0.1 to 10"))),
      loop_(
          named(new QCheckBox(tr("&Loop")), "timeline_loop", tr("After the end it begins again"))) {
    setObjectName("timeline");
    auto* row = row_in(this, {back_, play_, forward_, track_, text_, speed_, loop_});
    row->setContentsMargins(6, 2, 6, 2);
    row->setStretch(3, 1);
    back_->setAutoRepeat(true);
    forward_->setAutoRepeat(true);
    back_->setIcon(icon_of(Shape::back));
    forward_->setIcon(icon_of(Shape::forward));
    speed_->setAccessibleName(tr("Speed"));
    speed_->setSuffix(QString::fromUtf8("×"));
    speed_->show_value(play_speed_);
    speed_->setFixedWidth(fontMetrics().horizontalAdvance(QString::fromUtf8("0.0000×")) +
                          2 * fontMetrics().height());
    let_return_press_buttons(*this);
    connect_inputs();
    show_possible();
    show_playing();
}

void Timeline::connect_inputs() {
    connect(back_, &QToolButton::clicked, this, [this] { step(-1); });
    connect(forward_, &QToolButton::clicked, this, [this] { step(1); });
    connect(play_, &QToolButton::clicked, this,
            [this] { Q_EMIT speed_asked(playing() ? 0 : play_speed_); });
    connect(speed_, qOverload<double>(&NumberBox::valueChanged), this, [this](double speed) {
        const double bounded = std::clamp(speed, speed_steps.front(), speed_steps.back());
        speed_->show_value(bounded);
        const double asked = std::copysign(bounded, play_speed_);
        if (asked == std::exchange(play_speed_, asked)) return;
        if (playing()) Q_EMIT speed_asked(asked);
    });
    connect(loop_, &QCheckBox::clicked, this, &Timeline::loop_asked);
    connect(track_, &TimelineTrack::chosen, this, &Timeline::moment_asked);
    connect(track_, &TimelineTrack::stepped, this, &Timeline::step);
}

bool Timeline::dragging() const {
    return track_->isSliderDown();
}

void Timeline::toggle_playing() {
    play_->click();
}

void Timeline::step(int direction) {
    if (!track_->isEnabled()) return;
    const auto time = frame_beside(track_->view(), track_->time(), direction);
    if (!time) return;
    if (playing()) Q_EMIT speed_asked(0);
    Q_EMIT moment_asked(*time);
}

void Timeline::set_view(const TimelineView& view) {
    const bool other = track_->set_view(view);
    if (other) show_possible();
    if (other || !dragging()) track_->set_time(view.time);
    text_->setText(text_at(track_->view(), track_->time()));
    loop_->setChecked(view.loop);
    speed_now_ = view.speed;
    if (playing() && play_speed_ != view.speed) {
        play_speed_ = view.speed;
        speed_->show_value(std::abs(play_speed_));
    }
    show_playing();
}

/// Changes only what is shown otherwise.
void Timeline::show_playing() {
    const QString does = playing() ? tr("Pause") : tr("Play");
    if (does == play_->accessibleName()) return;
    play_->setIcon(icon_of(playing() ? Shape::pause : Shape::play));
    play_->setAccessibleName(does);
    play_->setToolTip(does);
}

/// Enables what is possible; makes the text as wide as it will ever be, so that nothing moves while
/// it plays.
void Timeline::show_possible() {
    const TimelineView& view = track_->view();
    setEnabled(!empty(view));
    for (QWidget* one : std::initializer_list<QWidget*>{back_, forward_, loop_, speed_}) {
        one->setEnabled(track_->isEnabled());
    }
    int width = 0;
    for (const double time : {view.begin, view.end}) {
        QString words = text_at(view, time);
        for (QChar& c : words) c = c.isDigit() ? QChar('0') : c;
        width = std::max(width, fontMetrics().horizontalAdvance(words));
    }
    text_->setMinimumWidth(width);
}

}  // namespace palpate::viewer
