// Converts colours between the model and Qt.
#pragma once

#include <QColor>

#include "apps/viewer/model/look.hpp"

namespace palpate::viewer {

inline QColor to_qt(const Colour& colour) {
    return QColor::fromRgbF(colour.red, colour.green, colour.blue);
}

inline Colour from_qt(const QColor& colour) {
    return {colour.redF(), colour.greenF(), colour.blueF()};
}

}  // namespace palpate::viewer
