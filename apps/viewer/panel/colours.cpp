// Draws the swatch and opens the colour dialog.
#include "apps/viewer/panel/colours.hpp"

#include <QColorDialog>
#include <QPainter>

namespace palpate::viewer {

bool is_dark(const QPalette& palette) {
    return palette.color(QPalette::Window).lightnessF() < 0.5;
}

QColor readable(const QColor& colour, const QPalette& palette) {
    if (is_dark(palette)) return colour.lighter(155);
    return colour.lightnessF() > 0.6 ? colour.darker(160) : colour;
}

QIcon icon_of(const Colour& colour) {
    QPixmap square(16, 16);
    square.fill(to_qt(colour));
    QIcon icon(square);
    icon.addPixmap(square, QIcon::Selected);
    return icon;
}

ColourButton::ColourButton(const QString& name, const QString& title) {
    setObjectName(name);
    setAccessibleName(title);
    setToolTip(title);
    setMinimumWidth(3 * fontMetrics().height());
    connect(this, &QPushButton::clicked, this, &ColourButton::choose);
}

void ColourButton::set_colour(const Colour& colour) {
    if (colour == colour_) return;
    colour_ = colour;
    update();
}

void ColourButton::choose() {
    auto* dialog = new QColorDialog(to_qt(colour_), this);
    dialog->setObjectName(objectName() + "_dialog");
    dialog->setWindowTitle(accessibleName());
    dialog->setOption(QColorDialog::DontUseNativeDialog);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    const Colour before = colour_;
    const auto want = [this](const Colour& colour) {
        if (colour == colour_) return;
        set_colour(colour);
        Q_EMIT wanted(colour);
    };
    connect(dialog, &QColorDialog::currentColorChanged, this,
            [want](const QColor& colour) { want(from_qt(colour)); });
    connect(dialog, &QColorDialog::rejected, this, [want, before] { want(before); });
    dialog->open();
}

void ColourButton::paintEvent(QPaintEvent* event) {
    QPushButton::paintEvent(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const double inset = 0.25 * fontMetrics().height();
    painter.setOpacity(isEnabled() ? 1 : 0.4);
    painter.setBrush(to_qt(colour_));
    painter.setPen(QPen(palette().color(QPalette::ButtonText), 1));
    painter.drawRoundedRect(QRectF(rect()).adjusted(inset, inset, -inset, -inset), 2, 2);
}

}  // namespace palpate::viewer
