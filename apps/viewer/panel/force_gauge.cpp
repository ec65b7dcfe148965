// Draws the force gauge.
#include "apps/viewer/panel/force_gauge.hpp"

#include <QPainter>
#include <QPainterPath>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/level_axis.hpp"

namespace palpate::viewer {
namespace {

constexpr Colour near_limit{0.835, 0.369, 0};

/// What `words` of app::force_words() mean: the word itself, a colon, and why.
QString meaning_of(const QString& words) {
    if (words == "off") return ForceGauge::tr("Off: forces are switched off");
    if (words == "recovering") return ForceGauge::tr("Recovering: the proxy is leaving the solid");
    if (words == "no input") {
        return ForceGauge::tr("No input: the device gives no reliable position");
    }
    if (words == "too late") {
        return ForceGauge::tr("Too late: a tick took too long, its force was cancelled");
    }
    if (words == "waiting") {
        return ForceGauge::tr("Waiting: forces begin when the hand is where they are small");
    }
    if (words == "ramp") {
        return ForceGauge::tr("Ramp: from zero to full force after a start or pause");
    }
    if (words == "limit") {
        return ForceGauge::tr("Limit: the computed force is larger than the limit");
    }
    if (words == "motors warm") {
        return ForceGauge::tr("Motors warm: the force is limited until they have cooled");
    }
    if (words == "rate limit") {
        return ForceGauge::tr("Rate limit: the force may not change faster");
    }
    return {};
}

/// The same words, in the person's language.
QString shown_words(const QString& words) {
    constexpr const char* known[] = {
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "off"),
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "recovering"),
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "not finite"),
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "no input"),
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "too late"),
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "waiting"),
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "ramp"),
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "limit"),
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "motors warm"),
        QT_TRANSLATE_NOOP("palpate::viewer::ForceGauge", "rate limit")};
    for (const char* one : known) {
        if (words == one) return ForceGauge::tr(one);
    }
    return words;
}

QString tip_for(const QString& words) {
    const QString what = ForceGauge::tr("Force on the hand [N] against the limit in use");
    const QString meaning = meaning_of(words);
    return meaning.isEmpty() ? what : what + "\n" + meaning;
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
    setAccessibleName(
        tr("Force %1 N of %2 N %3").arg(force, 0, 'f', 2).arg(limit).arg(shown_words(words)));
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
    painter.drawText(text.adjusted(after, 0, 0, 0), Qt::AlignLeft | Qt::AlignVCenter,
                     shown_words(words_));
    painter.setPen(palette().color(QPalette::PlaceholderText));
    if (limit_ > 0) {
        painter.drawText(text, Qt::AlignRight | Qt::AlignVCenter,
                         tr("of %1 N").arg(QString::number(limit_, 'g', 3)));
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
