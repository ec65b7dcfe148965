// Draws the force gauge.
#include "apps/viewer/panel/force_gauge.hpp"

#include <QMap>
#include <QPainter>
#include <QPainterPath>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/level_axis.hpp"

namespace palpate::viewer {
namespace {

constexpr Colour near_limit{0.835, 0.369, 0};

/// The tooltip, with what `words` of app::force_words() mean.
QString tip_for(const QString& words) {
    static const QMap<QString, QString> meanings{
        {"off", "Off: forces are switched off"},
        {"recovering", "Recovering: the proxy is leaving the solid"},
        {"no input", "No input: the device gives no reliable position"},
        {"too late", "Too late: a tick took too long, its force was cancelled"},
        {"waiting", "Waiting: forces begin when the hand is where they are small"},
        {"ramp", "Ramp: from zero to full force after a start or pause"},
        {"limit", "Limit: the computed force is larger than the limit"},
        {"rate limit", "Rate limit: the force may not change faster"}};
    const QString what = "Force on the hand [N] against the limit in use";
    return meanings.contains(words) ? what + "\n" + meanings[words] : what;
}

}  // namespace

ForceGauge::ForceGauge() {
    setObjectName("force_gauge");
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    setToolTip(tip_for({}));
}

void ForceGauge::set_force(double force, double limit, const QString& words) {
    if (words != words_) setToolTip(tip_for(words));
    // Called thirty times a second: repaints only where the change can be seen.
    const bool seen = words != words_ || limit != limit_ || std::abs(force - force_) > 0.002;
    if (!seen) return;
    force_ = force;
    limit_ = limit;
    words_ = words;
    setAccessibleName(QString("Force %1 N of %2 N %3").arg(force, 0, 'f', 2).arg(limit).arg(words));
    update();
}

void ForceGauge::clear() {
    set_force(0, 0, {});
}

double ForceGauge::filled() const {
    return limit_ > 0 ? std::clamp(force_ / limit_, 0.0, 1.0) : 0;
}

QSize ForceGauge::sizeHint() const {
    const int height = fontMetrics().height();
    return {14 * height, static_cast<int>(2.4 * height)};
}

QSize ForceGauge::minimumSizeHint() const {
    return {9 * fontMetrics().height(), sizeHint().height()};
}

void ForceGauge::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const double line = fontMetrics().height();
    const QRectF all = QRectF(rect()).adjusted(0.5, 0.5, -0.5, -0.5);
    QFont bold = font();
    bold.setBold(true);
    painter.setFont(bold);
    painter.setPen(
        palette().color(isEnabled() ? QPalette::Active : QPalette::Disabled, QPalette::WindowText));
    const QRectF text(all.left(), all.top(), all.width(), line * 1.15);
    const QString number = QString("%1 N").arg(force_, 0, 'f', 2);
    painter.drawText(text, Qt::AlignLeft | Qt::AlignVCenter, number);
    const double after = QFontMetricsF(bold).horizontalAdvance(number) + 0.6 * line;
    painter.setFont(font());
    painter.drawText(text.adjusted(after, 0, 0, 0), Qt::AlignLeft | Qt::AlignVCenter, words_);
    painter.setPen(palette().color(QPalette::PlaceholderText));
    if (limit_ > 0) {
        painter.drawText(text, Qt::AlignRight | Qt::AlignVCenter,
                         QString("of %1 N").arg(QString::number(limit_, 'g', 3)));
    }
    const QRectF bar(all.left(), text.bottom() + 1, all.width(), all.bottom() - text.bottom() - 1);
    QPainterPath frame;
    frame.addRoundedRect(bar, 3, 3);
    painter.fillPath(frame, palette().color(QPalette::Base));
    painter.save();
    painter.setClipPath(frame);
    const bool high = filled() > 0.9;
    painter.fillRect(QRectF(bar.left(), bar.top(), bar.width() * filled(), bar.height()),
                     readable(to_qt(high ? near_limit : pictures::force_colour), palette()));
    painter.restore();
    painter.setPen(QPen(palette().color(QPalette::Mid), 1));
    painter.drawPath(frame);
}

}  // namespace palpate::viewer
