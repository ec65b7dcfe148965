// Colours of the model in Qt, a button to choose one, and icons of tool buttons.
#pragma once

#include <QColor>
#include <QIcon>
#include <QPushButton>

#include "apps/viewer/model/look.hpp"

namespace palpate::viewer {

inline QColor to_qt(const Colour& colour) {
    return QColor::fromRgbF(colour.red, colour.green, colour.blue);
}

inline Colour from_qt(const QColor& colour) {
    return {colour.redF(), colour.greenF(), colour.blueF()};
}

bool is_dark(const QPalette& palette);
/// The colour, lighter on a dark palette, and darker on a light one if it is pale: thin lines and
/// small text stay readable.
QColor readable(const QColor& colour, const QPalette& palette);

/// A square of it, for lists; not tinted where it is chosen.
QIcon icon_of(const Colour& colour);

/// A button that shows a colour and opens a dialog to choose another.
class ColourButton : public QPushButton {
    Q_OBJECT

  public:
    ColourButton(const QString& name, const QString& title);

    /// Shows a colour; emits nothing.
    void set_colour(const Colour& colour);
    const Colour& colour() const { return colour_; }
    /// Opens the dialog, as a click does; the window keeps working.
    void choose();

  Q_SIGNALS:
    /// Also emitted while the dialog is open, so that the scene shows the colour; cancelling emits
    /// the old one.
    void wanted(const palpate::viewer::Colour& colour);

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    Colour colour_;
};

enum class Shape {
    back,
    brush,
    cut,
    eye,
    forces,
    forward,
    freeze,
    layout,
    measure,
    open,
    pause,
    play,
    record,
    redo,
    touch,
    undo,
    whole
};

/// An icon at any size, in the colour that text on buttons has whenever it is painted.
QIcon icon_of(Shape shape);

}  // namespace palpate::viewer
