// The time line's controls and its clock.
#include "apps/viewer/slices/time_line.hpp"

#include <QCheckBox>
#include <QComboBox>
#include <QEvent>
#include <QHBoxLayout>
#include <QHideEvent>
#include <QLabel>
#include <QPainter>
#include <QToolButton>

#include <array>
#include <cmath>

#include "apps/viewer/slices/time_track.hpp"

namespace palpate::viewer {
namespace {

constexpr std::array speeds{0.1, 0.25, 0.5, 1.0, 2.0, 4.0};
constexpr int real_time = 3;          // of the speeds
constexpr int between_steps_ms = 16;  // a frame of a screen

/// "1:02.345"; hours where there are any.
QString clock_text(double seconds) {
    const auto all = static_cast<long long>(std::floor(1e3 * seconds + 0.5));
    const long long minutes = all / 60'000 % 60, hours = all / 3'600'000;
    const QString rest =
        QString("%1.%2").arg(all / 1000 % 60, 2, 10, QChar('0')).arg(all % 1000, 3, 10, QChar('0'));
    return hours > 0 ? QString("%1:%2:%3").arg(hours).arg(minutes, 2, 10, QChar('0')).arg(rest)
                     : QString("%1:%2").arg(minutes).arg(rest);
}

}  // namespace

TimeLine::TimeLine(QWidget* parent)
    : QWidget(parent),
      button_(new QToolButton),
      track_(new TimeTrack),
      label_(new QLabel),
      speed_(new QComboBox),
      loop_(new QCheckBox(tr("&Loop"))) {
    setObjectName("time_line");
    build();
    timer_.setInterval(between_steps_ms);
    timer_.setTimerType(Qt::PreciseTimer);
    connect(&timer_, &QTimer::timeout, this, &TimeLine::advance);
    connect(button_, &QToolButton::clicked, this, [this] { set_playing(!playing()); });
    connect(track_, &TimeTrack::chosen, this, [this](double time) {
        since_.restart();
        show_time();
        Q_EMIT time_chosen(overview_.begin + time);
    });
    clear();
}

void TimeLine::build() {
    auto* layout = new QHBoxLayout(this);
    layout->addWidget(button_);
    layout->addWidget(track_, 1);
    layout->addWidget(label_);
    layout->addWidget(speed_);
    layout->addWidget(loop_);
    button_->setObjectName("play");
    button_->setAutoRaise(true);
    label_->setObjectName("time");
    label_->setToolTip(tr("Time and length of the recording [minutes:seconds]"));
    speed_->setObjectName("speed");
    speed_->setToolTip(tr("Seconds of the recording in a second"));
    speed_->setAccessibleName(tr("Speed"));
    for (const double speed : speeds) speed_->addItem(QString::fromUtf8("%1×").arg(speed), speed);
    speed_->setCurrentIndex(real_time);
    loop_->setObjectName("loop");
    loop_->setToolTip(tr("After its end the recording begins again"));
}

void TimeLine::set_overview(const Overview& overview) {
    set_playing(false);
    overview_ = overview;
    track_->set_overview(overview_);
    setEnabled(!overview_.pieces.empty());
    // As wide as it will ever be: nothing moves while it plays.
    const QString longest = clock_text(track_->length());
    label_->setText(longest + " / " + longest);
    label_->setMinimumWidth(label_->sizeHint().width());
    show_time();
    show_state();
}

void TimeLine::clear() {
    set_overview({});
}

double TimeLine::time() const {
    return overview_.begin + track_->time();
}

void TimeLine::set_time(double time) {
    track_->set_time(time - overview_.begin);
    show_time();
}

void TimeLine::set_playing(bool playing) {
    if (playing == timer_.isActive() || (playing && overview_.pieces.empty())) return;
    if (playing) {
        if (track_->time() >= track_->length()) track_->set_time(0);
        since_.start();
        timer_.start();
    } else {
        timer_.stop();
    }
    show_state();
    Q_EMIT playing_changed(playing);
}

double TimeLine::speed() const {
    return speed_->currentData().toDouble();
}

void TimeLine::set_speed(double speed) {
    int best = real_time;
    for (int i = 0; i < static_cast<int>(speeds.size()); ++i) {
        const auto distance = [&](int k) {
            return std::abs(speeds[static_cast<std::size_t>(k)] - speed);
        };
        if (distance(i) < distance(best)) best = i;
    }
    speed_->setCurrentIndex(best);
}

bool TimeLine::loops() const {
    return loop_->isChecked();
}

void TimeLine::set_loop(bool loop) {
    loop_->setChecked(loop);
}

/// Time goes on by what has passed since, so a window that is busy skips and does not slow down.
void TimeLine::advance() {
    const double passed = 1e-9 * static_cast<double>(since_.nsecsElapsed()) * speed();
    since_.restart();
    if (track_->isSliderDown()) return;
    const double length = track_->length();
    const double to = track_->time() + passed;
    const bool ended = to >= length;
    const bool again = ended && loops() && length > 0;
    track_->set_time(again ? std::fmod(to, length) : to);
    show_time();
    if (ended && !again) set_playing(false);
    Q_EMIT time_chosen(time());
}

void TimeLine::show_time() {
    label_->setText(clock_text(track_->time()) + " / " + clock_text(track_->length()));
}

/// In the colour of words, which a style's own icons are not.
QIcon TimeLine::icon(bool pause) const {
    const QSize size = button_->iconSize();
    QPixmap picture(size * devicePixelRatioF());
    picture.setDevicePixelRatio(devicePixelRatioF());
    picture.fill(Qt::transparent);
    QPainter painter(&picture);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(palette().buttonText());
    painter.scale(size.width(), size.height());
    if (pause) {
        painter.drawRect(QRectF(0.22, 0.15, 0.2, 0.7));
        painter.drawRect(QRectF(0.58, 0.15, 0.2, 0.7));
    } else {
        painter.drawPolygon(QPolygonF({{0.25, 0.12}, {0.25, 0.88}, {0.85, 0.5}}));
    }
    return picture;
}

void TimeLine::show_state() {
    const bool on = playing();
    button_->setIcon(icon(on));
    button_->setAccessibleName(on ? tr("Pause") : tr("Play"));
    button_->setToolTip(on ? tr("Pause") : tr("Play the recording"));
}

void TimeLine::hideEvent(QHideEvent* event) {
    if (!event->spontaneous()) set_playing(false);  // not where the window is but iconified
    QWidget::hideEvent(event);
}

void TimeLine::changeEvent(QEvent* event) {
    if (event->type() == QEvent::PaletteChange) show_state();
    QWidget::changeEvent(event);
}

}  // namespace palpate::viewer
