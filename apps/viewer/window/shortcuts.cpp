// Makes the list of shortcuts from the actions themselves, so that it is always up to date.
#include "apps/viewer/window/shortcuts.hpp"

#include <QAction>
#include <QDialog>
#include <QDialogButtonBox>
#include <QTextBrowser>
#include <QVBoxLayout>

namespace palpate::viewer {
namespace {

QString row(const QString& keys, const QString& what) {
    return QString("<tr><td style='padding-right:2em'><b>%1</b></td><td>%2</td></tr>")
        .arg(keys.toHtmlEscaped(), what.toHtmlEscaped());
}

QString mouse_table() {
    return "<h3>Mouse in the scene</h3><table>" +
           row("Left drag",
               "turn; with the mouse as device: move the probe in the plane of the view") +
           row("Wheel",
               "zoom; with the mouse as device: probe into the depth (Shift: finely; Ctrl: zoom)") +
           row("Right drag", "zoom; with the mouse as device: turn (Shift or middle: pan)") +
           row("Double click", "centre there") + "</table><h3>Mouse in a slice</h3><table>" +
           row("Left", "crosshair; with the mouse as device: the probe (Ctrl: crosshair)") +
           row("Wheel", "next slice (Ctrl: zoom)") + row("Right drag", "window and level") +
           row("Middle drag", "pan; double click resets") + "</table>";
}

}  // namespace

QDialog* make_shortcuts_dialog(QWidget* window) {
    auto* dialog = new QDialog(window);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setObjectName("shortcuts");
    dialog->setWindowTitle("Shortcuts");
    QString text = "<h3>Keys</h3><table>";
    for (const QAction* action : window->findChildren<QAction*>()) {
        if (action->shortcut().isEmpty()) continue;
        text += row(action->shortcut().toString(QKeySequence::NativeText),
                    action->text().remove('&').remove(QString::fromUtf8("\u2026")));
    }
    text += "</table>" + mouse_table();
    auto* browser = new QTextBrowser;
    browser->setHtml(text);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    QObject::connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    auto* layout = new QVBoxLayout(dialog);
    layout->addWidget(browser);
    layout->addWidget(buttons);
    dialog->resize(36 * dialog->fontMetrics().averageCharWidth() * 2,
                   36 * dialog->fontMetrics().height());
    return dialog;
}

}  // namespace palpate::viewer
