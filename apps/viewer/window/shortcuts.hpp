// A dialog that lists what keys and mouse do.
#pragma once

class QDialog;
class QWidget;

namespace palpate::viewer {

/// A dialog that lists the shortcuts of all actions of `window`, and what the mouse does. It is
/// deleted when it is closed.
QDialog* make_shortcuts_dialog(QWidget* window);

}  // namespace palpate::viewer
