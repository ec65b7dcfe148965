// Controls of the timeline, and the track: shows views, emits the actions of the user.
#include "apps/viewer/panel/timeline.hpp"

#include <QBoxLayout>
#include <QCheckBox>
#include <QFontMetrics>
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
#include <limits>
#include <tuple>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/icons.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {
namespace {

constexpr double least_between_ticks = 3;  // pixels

}  // namespace

TimelineTrack::TimelineTrack() {
    setObjectName("timeline_track");
    setAccessibleName(tr("Time [ms]"));
    setAccessibleDescription(tr("Arrows go from frame to frame"));
    setFocusPolicy(Qt::StrongFocus);
    setOrientation(Qt::Horizontal);
    // By keys, and by whatever else moves a slider.
    connect(this, &QAbstractSlider::valueChanged, this, [this](int milliseconds) {
        time_ = view_.begin + std::min(1e-3 * milliseconds, length());
        update();
        Q_EMIT chosen(time_);
    });
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

double TimelineTrack::length() const {
    return std::max(view_.end - view_.begin, 0.0);
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
    setRange(0, static_cast<int>(std::min(std::ceil(1e3 * length()), 2e9)));
    setSingleStep(std::max(1, maximum() / 100));
    setPageStep(std::max(1, maximum() / 10));
    setEnabled(!view.live && length() > 0);
    updateGeometry();
    time_ = within(view_, time_);
    place();
    return true;
}

void TimelineTrack::set_time(double time) {
    const double to = within(view_, time);
    if (to == time_) return;
    time_ = to;
    place();
    update();
}

/// The slider's value at the time.
void TimelineTrack::place() {
    const QSignalBlocker quiet(this);
    setValue(static_cast<int>(std::lround(std::min(1e3 * (time_ - view_.begin), 2e9))));
}

QSize TimelineTrack::sizeHint() const {
    const int height = QFontMetrics(font()).height();
    return {24 * height, (view_.overview ? 3 : 2) * height};
}

QSize TimelineTrack::minimumSizeHint() const {
    const int height = QFontMetrics(font()).height();
    return {6 * height, 2 * height};
}

QRectF TimelineTrack::plot() const {
    const double edge = 0.4 * QFontMetricsF(font()).height();
    return QRectF(rect()).adjusted(edge, 2, -edge, -2);
}

double TimelineTrack::x_of(double time) const {
    const QRectF box = plot();
    return length() > 0 ? box.left() + box.width() * (time - view_.begin) / length() : box.left();
}

double TimelineTrack::time_at(double x) const {
    const QRectF box = plot();
    const double part = std::clamp((x - box.left()) / std::max(box.width(), 1.0), 0.0, 1.0);
    return part == 1 ? view_.end : view_.begin + part * length();
}

void TimelineTrack::choose_at(double x) {
    set_time(time_at(x));
    Q_EMIT chosen(time_);
}

bool TimelineTrack::event(QEvent* event) {
    if (event->type() == QEvent::ToolTip && !empty(view_) && !view_.live) {
        const auto* const help = static_cast<QHelpEvent*>(event);
        const double time = time_at(help->pos().x());
        QToolTip::showText(help->globalPos(),
                           view_.overview ? overview_text_at(view_, time) : text_at(view_, time));
        return true;
    }
    return QAbstractSlider::event(event);
}

void TimelineTrack::paint_loaded(QPainter& painter, const QRectF& box) const {
    QColor loaded = palette().color(QPalette::Highlight);
    loaded.setAlphaF(0.4);
    for (const Overview::Interval& one : loaded_stretches(view_)) {
        const double from = x_of(one.from), to = x_of(one.to);
        painter.fillRect(QRectF(from, box.top(), std::max(to - from, 2.0), box.height()), loaded);
    }
}

/// One line for each frame; fewer where they would run together.
void TimelineTrack::paint_frames(QPainter& painter, const QRectF& box) const {
    QColor colour = palette().color(QPalette::Text);
    colour.setAlphaF(0.6);
    painter.setPen(QPen(colour, 1));
    double last = -std::numeric_limits<double>::infinity();
    for (const double frame : view_.frames) {
        const double x = x_of(frame);
        if (x - last < least_between_ticks || x > box.right() + 0.5) continue;
        painter.drawLine(QPointF(x, box.bottom() - 0.4 * box.height()), QPointF(x, box.bottom()));
        last = x;
    }
}

/// One column of pixels at a time.
void TimelineTrack::paint_overview(QPainter& painter, const QRectF& box) const {
    const Overview& overview = *view_.overview;
    Overview::Piece whole;
    for (const Overview::Piece& piece : overview.pieces) whole.add(piece);
    if (whole.empty) return;
    const double level_range = whole.most_isovalue - whole.least_isovalue;
    const int columns = std::max(1, static_cast<int>(box.width() * devicePixelRatioF()));
    const double step = box.width() / columns;
    const auto count = static_cast<double>(overview.pieces.size());
    const double shown = length() > 0 ? length() / overview.width : 1;  // pieces
    QColor force = to_qt(pictures::force_colour);
    force.setAlphaF(0.55);
    painter.setPen(Qt::NoPen);
    for (int c = 0; c < columns; ++c) {
        const auto first = static_cast<std::size_t>(std::min(shown * c / columns, count - 1));
        const auto last = static_cast<std::size_t>(std::min(shown * (c + 1) / columns, count - 1));
        Overview::Piece column;
        for (std::size_t i = first; i <= last; ++i) column.add(overview.pieces[i]);
        if (column.empty) continue;
        const double x = box.left() + c * step;
        const auto fill = [&](double top, double bottom, const QColor& colour) {
            painter.fillRect(QRectF(x, top, step, bottom - top), colour);
        };
        if (whole.most_force > 0) {
            const double newton = box.height() / whole.most_force;
            fill(box.bottom() - newton * column.most_force, box.bottom(), force);
            fill(box.bottom() - newton * column.least_force, box.bottom(), force);
        }
        if (level_range > 0 && column.least_isovalue <= column.most_isovalue) {
            const double unit = (box.height() - 2) / level_range, zero = box.bottom() - 1;
            fill(zero - unit * (column.most_isovalue - whole.least_isovalue) - 0.75,
                 zero - unit * (column.least_isovalue - whole.least_isovalue) + 0.75,
                 palette().color(QPalette::Text));
        }
    }
}

void TimelineTrack::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const QRectF box = plot();
    const QPalette colours = palette();
    painter.fillRect(box, colours.base());
    if (view_.overview) {
        const double bar = std::max(3.0, 0.15 * box.height());
        paint_overview(painter, box.adjusted(0, 2, 0, -bar - 2));
        for (const Overview::Interval& contact : view_.overview->contacts) {
            const double from = x_of(contact.from), to = x_of(contact.to);
            painter.fillRect(QRectF(from, box.bottom() - bar, std::max(to - from, 1.0), bar),
                             to_qt(pictures::scp_colour));
        }
    } else if (!view_.live) {
        paint_loaded(painter, box);
        paint_frames(painter, box);
    }
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(
        QPen(hasFocus() ? colours.highlight().color() : colours.mid().color(), hasFocus() ? 2 : 1));
    painter.drawRect(box);
    if (!isEnabled()) return;
    const double x = x_of(time_), head = 0.35 * QFontMetricsF(font()).height();
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
    choose_at(event->localPos().x());
}

void TimelineTrack::mouseMoveEvent(QMouseEvent* event) {
    if (isSliderDown()) choose_at(event->localPos().x());
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
        double to = value();
        for (int i = 0; i < std::abs(count); ++i) {
            if (count > 0) {
                const auto above = std::ranges::upper_bound(speed_steps, to);
                to = above == speed_steps.end() ? speed_steps.back() : *above;
            } else {
                const auto from = std::ranges::lower_bound(speed_steps, to);
                to = from == speed_steps.begin() ? speed_steps.front() : *(from - 1);
            }
        }
        setValue(to);
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
      play_(make_button("timeline_play", tr("Play"), tr("Play"))),
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
    speed_->setAccessibleName(tr("Speed"));
    speed_->setSuffix(QString::fromUtf8("×"));
    speed_->show_value(play_speed_);
    speed_->setFixedWidth(fontMetrics().horizontalAdvance(QString::fromUtf8("0.0000×")) +
                          2 * fontMetrics().height());
    let_return_press_buttons(*this);
    connect_inputs();
    show_playing(false);
    back_->setIcon(icon_of(Shape::back));
    forward_->setIcon(icon_of(Shape::forward));
    show_possible();
}

void Timeline::connect_inputs() {
    connect(back_, &QToolButton::clicked, this, [this] { step(-1); });
    connect(forward_, &QToolButton::clicked, this, [this] { step(1); });
    connect(play_, &QToolButton::clicked, this, [this] {
        const bool play = !playing_;
        show_playing(play);
        ask_speed(play ? play_speed_ : 0);
    });
    connect(speed_, qOverload<double>(&NumberBox::valueChanged), this, [this](double speed) {
        const double bounded = std::clamp(speed, speed_steps.front(), speed_steps.back());
        speed_->show_value(bounded);
        const double asked = std::copysign(bounded, play_speed_);
        if (asked == play_speed_) return;
        play_speed_ = asked;
        if (playing_) ask_speed(asked);
    });
    connect(loop_, &QCheckBox::clicked, this, [this](bool loop) {
        awaited_loop_.begin();
        Q_EMIT loop_asked(loop);
    });
    connect(track_, &TimelineTrack::chosen, this, &Timeline::ask_moment);
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
    if (playing_) {
        show_playing(false);
        ask_speed(0);
    }
    track_->set_time(*time);
    ask_moment(track_->time());
}

void Timeline::ask_speed(double speed) {
    awaited_speed_.begin();
    Q_EMIT speed_asked(speed);
}

void Timeline::ask_moment(double time) {
    asked_time_ = time;
    awaited_time_.begin();
    show_text();
    Q_EMIT moment_asked(time);
}

void Timeline::set_view(const TimelineView& view) {
    if (track_->set_view(view)) {
        awaited_time_.end();
        show_possible();
    }
    show_speed(view.speed);
    if (!awaited_loop_.passes_over(view.loop == loop_->isChecked())) loop_->setChecked(view.loop);
    show_time(view.time);
}

void Timeline::show_speed(double speed) {
    const bool playing = speed != 0;
    const bool same = playing == playing_ && (!playing || speed == play_speed_);
    if (awaited_speed_.passes_over(same) || same) return;
    if (playing) {
        play_speed_ = speed;
        speed_->show_value(std::abs(speed));
    }
    show_playing(playing);
}

void Timeline::show_time(double time) {
    if (dragging() || awaited_time_.passes_over(time == asked_time_)) return;
    track_->set_time(time);
    show_text();
}

void Timeline::show_text() {
    text_->setText(text_at(track_->view(), track_->time()));
}

/// Enables what is possible; makes the text as wide as it will ever be, so that nothing moves while
/// it plays.
void Timeline::show_possible() {
    const TimelineView& view = track_->view();
    setEnabled(!empty(view));
    const bool seeks = track_->isEnabled();
    back_->setEnabled(seeks);
    forward_->setEnabled(seeks);
    loop_->setEnabled(seeks);
    speed_->setEnabled(seeks);
    int width = 0;
    for (const double time : {view.begin, view.end}) {
        QString words = text_at(view, time);
        for (QChar& c : words) c = c.isDigit() ? QChar('0') : c;
        width = std::max(width, fontMetrics().horizontalAdvance(words));
    }
    text_->setMinimumWidth(width);
    show_text();
}

void Timeline::show_playing(bool playing) {
    if (playing == playing_ && !play_->icon().isNull()) return;
    playing_ = playing;
    play_->setIcon(icon_of(playing ? Shape::pause : Shape::play));
    play_->setAccessibleName(playing ? tr("Pause") : tr("Play"));
    play_->setToolTip(play_->accessibleName());
}

}  // namespace palpate::viewer
