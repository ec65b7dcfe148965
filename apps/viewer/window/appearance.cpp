// Sets light and dark palettes of the Fusion style.
#include "apps/viewer/window/appearance.hpp"

#include <QApplication>
#include <QPalette>
#include <QSettings>

namespace palpate::viewer {
namespace {

QPalette palette_of(const QColor& window, const QColor& base, const QColor& text,
                    const QColor& faint) {
    QPalette palette(window, window);  // buttons, and what is made from them
    for (const auto role : {QPalette::WindowText, QPalette::ButtonText, QPalette::BrightText}) {
        palette.setColor(role, text);
    }
    palette.setColor(QPalette::Base, base);
    palette.setColor(QPalette::AlternateBase, window);
    palette.setColor(QPalette::Text, text);
    palette.setColor(QPalette::ToolTipBase, base);
    palette.setColor(QPalette::ToolTipText, text);
    palette.setColor(QPalette::PlaceholderText, faint);
    palette.setColor(QPalette::Highlight, QColor(0, 114, 178));
    palette.setColor(QPalette::HighlightedText, Qt::white);
    palette.setColor(QPalette::Link, QColor(86, 180, 233));
    for (const auto role : {QPalette::Text, QPalette::WindowText, QPalette::ButtonText}) {
        palette.setColor(QPalette::Disabled, role, faint);
    }
    return palette;
}

}  // namespace

void set_appearance(Appearance appearance) {
    static const QPalette system = QApplication::palette();
    QSettings().setValue("appearance", static_cast<int>(appearance));
    switch (appearance) {
        case Appearance::system:
            QApplication::setPalette(system);
            break;
        case Appearance::light:
            QApplication::setPalette(
                palette_of(QColor(239, 239, 239), Qt::white, QColor(20, 20, 20), Qt::gray));
            break;
        case Appearance::dark:
            QApplication::setPalette(palette_of(QColor(45, 46, 48), QColor(30, 31, 33),
                                                QColor(226, 226, 226), QColor(130, 130, 130)));
            break;
    }
}

Appearance last_appearance() {
    const int last = QSettings().value("appearance", 0).toInt();
    return last == 1 ? Appearance::light : last == 2 ? Appearance::dark : Appearance::system;
}

}  // namespace palpate::viewer
