// Penetrability as it is set in the panel, and the core's value for it. No Qt.
#pragma once

#include "apps/viewer/panel/range_bands.hpp"

namespace palpate::viewer {

/// What the panel shows; settings of modes that are not in use are kept for later.
struct PressThrough {
    enum class Mode { off, threshold, ranges };

    Mode mode = Mode::off;
    double threshold = 1;  ///< PT [device mm]
    double minimum = 0;    ///< [data units] least level felt (greatest where below is solid)
    Ranges ranges;         ///< [data units] in any order

    PenetrabilityFunction function = nullptr;  ///< kept as it came
    const void* context = nullptr;
};

/// The core's setting. Throws std::invalid_argument as penetrability_threshold and _ranges do.
Penetrability penetrability_of(const PressThrough& shown, Solid solid);

/// How a setting is shown; modes that it does not use keep their values from `before`.
PressThrough shown_from(const Penetrability& penetrability, Solid solid, PressThrough before);

/// The defaults for data of this range [data units]: a minimum at the level, and one range that
/// begins there and spans a tenth of the data.
PressThrough first_press_through(double isovalue, double low, double high, Solid solid);

/// The bands on the chart, rising: the ranges, or everything past the minimum; none in mode off.
Ranges bands_of(const PressThrough& shown, Solid solid);
/// The inverse: bands that were dragged become ranges or the minimum.
PressThrough with_bands(PressThrough shown, const Ranges& bands, Solid solid);

}  // namespace palpate::viewer
