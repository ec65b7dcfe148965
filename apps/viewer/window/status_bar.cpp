// Paints the message in the room that is left.
#include "apps/viewer/window/status_bar.hpp"

#include <QPainter>
#include <QStyle>
#include <QStyleOption>

#include <algorithm>

#include "apps/viewer/panel/layout.hpp"

namespace palpate::viewer {

namespace {

constexpr int margin_px = 6;

}  // namespace

StatusBar::StatusBar(QWidget* parent) : QStatusBar(parent), readout_(new QLabel) {
    named(readout_, "readout", tr("The proxy: where it is, the sample there and its slope"));
    readout_->setIndent(fontMetrics().height());  // apart from a message
    addPermanentWidget(readout_);
    connect(this, &QStatusBar::messageChanged, this, &StatusBar::show_message);
}

void StatusBar::show_readout(const QString& text) {
    readout_->setText(text);
    make_room();
}

void StatusBar::show_message(const QString& text) {
    setToolTip(text.isEmpty() ? "" : "<p>" + text.toHtmlEscaped() + "</p>");
    readout_->show();
    make_room();
}

/// The readout stays away until the message changes: it would flicker with the length of its
/// numbers.
void StatusBar::make_room() {
    if (currentMessage().isEmpty() || readout_->isHidden()) return;
    int needed = fontMetrics().horizontalAdvance(currentMessage()) + 2 * margin_px;
    for (const auto* one : findChildren<QWidget*>(QString(), Qt::FindDirectChildrenOnly)) {
        if (!one->isHidden()) needed += one->sizeHint().width() + margin_px;
    }
    if (needed > width()) readout_->hide();
}

QRect StatusBar::room() const {
    int right = width();
    for (const auto* one : findChildren<QWidget*>(QString(), Qt::FindDirectChildrenOnly)) {
        if (!one->isHidden()) right = std::min(right, one->x());
    }
    return rect().adjusted(margin_px, 0, right - width() - margin_px, 0);
}

/// As Qt's, but with dots at the end of what is too long.
void StatusBar::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    QStyleOption option;
    option.initFrom(this);
    style()->drawPrimitive(QStyle::PE_PanelStatusBar, &option, &painter, this);
    painter.setPen(palette().windowText().color());
    painter.drawText(room(), Qt::AlignLeft | Qt::AlignVCenter | Qt::TextSingleLine,
                     fontMetrics().elidedText(currentMessage(), Qt::ElideRight, room().width()));
}

void StatusBar::resizeEvent(QResizeEvent* event) {
    QStatusBar::resizeEvent(event);
    readout_->show();
    make_room();
}

}  // namespace palpate::viewer
