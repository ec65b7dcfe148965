// Controls of the timeline: shows views, emits the actions of the user.
#include "apps/viewer/panel/timeline.hpp"

#include <QBoxLayout>
#include <QCheckBox>
#include <QLabel>
#include <QToolButton>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/viewer/panel/icons.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/number_box.hpp"
#include "apps/viewer/panel/timeline_track.hpp"

namespace palpate::viewer {
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
          named(new QCheckBox(tr("&Loop")), "timeline_loop", tr("After the end it begins again"))),
      limiter_(this) {
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
    connect(track_, &TimelineTrack::sliderReleased, &limiter_, &RateLimiter::flush);
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
    limiter_.flush();
}

void Timeline::ask_speed(double speed) {
    awaited_speed_.begin();
    Q_EMIT speed_asked(speed);
}

void Timeline::ask_moment(double time) {
    asked_time_ = time;
    awaited_time_.begin();
    show_text();
    limiter_.put([this, time] { Q_EMIT moment_asked(time); });
}

void Timeline::set_view(const TimelineView& view) {
    if (track_->set_view(view)) {
        limiter_.drop();  // a moment of the former sequence
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
