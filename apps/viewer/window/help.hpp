// The dialogs of the menu Help. Each is deleted when it is closed.
#pragma once

class QDialog;
class QWidget;

namespace palpate::viewer {

/// How to open, touch and edit a volume, on a page.
QDialog* make_first_steps_dialog(QWidget* window);
/// The shortcuts of all actions of `window`, and what the mouse does.
QDialog* make_shortcuts_dialog(QWidget* window);
/// Versions, source and licence.
QDialog* make_about_dialog(QWidget* window);

}  // namespace palpate::viewer
