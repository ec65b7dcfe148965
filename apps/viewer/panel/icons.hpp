// Icons of tool buttons, drawn in the colour of their text.
#pragma once

#include <QIcon>

namespace palpate::viewer {

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
