// Converts between the panel's modes and the core's penetrability ranges.
#include "apps/viewer/panel/press_through.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::viewer {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Ranges rising(Ranges ranges) {
    std::ranges::sort(ranges, {}, &DensityRange::low);
    return ranges;
}

}  // namespace

Penetrability penetrability_of(const PressThrough& shown, Solid solid) {
    if (shown.mode == PressThrough::Mode::off) return no_penetrability();
    Penetrability p = shown.mode == PressThrough::Mode::threshold
                          ? penetrability_threshold(shown.threshold, shown.minimum, solid)
                          : penetrability_ranges(shown.threshold, shown.ranges, solid);
    p.function = shown.function;
    p.context = shown.context;
    return p;
}

PressThrough shown_from(const Penetrability& p, Solid solid, PressThrough before) {
    // A single range without a far end is a threshold with a minimum, unless it was made as a
    // range.
    const bool as_ranges = before.mode == PressThrough::Mode::ranges;
    PressThrough shown = std::move(before);
    shown.mode = PressThrough::Mode::off;
    if (!p.on) return shown;
    shown.threshold = p.threshold;
    shown.function = p.function;
    shown.context = p.context;
    const DensityRange& first = p.ranges[0];
    const double far = solid == Solid::above ? first.high : -first.low;
    if (!as_ranges && p.range_count == 1 && far == infinity) {
        shown.mode = PressThrough::Mode::threshold;
        shown.minimum = solid == Solid::above ? first.low : first.high;
        return shown;
    }
    shown.mode = PressThrough::Mode::ranges;
    shown.ranges = rising(Ranges(p.ranges.begin(), p.ranges.begin() + p.range_count));
    return shown;
}

PressThrough first_press_through(double isovalue, double low, double high, Solid solid) {
    PressThrough shown;
    const double begin = std::isfinite(isovalue) ? std::clamp(isovalue, low, high) : low;
    shown.minimum = begin;
    const double width = 0.1 * (high - low);
    shown.ranges = {solid == Solid::above ? DensityRange{begin, begin + width}
                                          : DensityRange{begin - width, begin}};
    return shown;
}

Ranges bands_of(const PressThrough& shown, Solid solid) {
    switch (shown.mode) {
        case PressThrough::Mode::off:
            return {};
        case PressThrough::Mode::threshold:
            return {solid == Solid::above ? DensityRange{shown.minimum, infinity}
                                          : DensityRange{-infinity, shown.minimum}};
        case PressThrough::Mode::ranges:
            break;
    }
    return shown.ranges;
}

PressThrough with_bands(PressThrough shown, const Ranges& bands, Solid solid) {
    if (shown.mode == PressThrough::Mode::threshold && !bands.empty()) {
        shown.minimum = solid == Solid::above ? bands.front().low : bands.front().high;
    } else if (shown.mode == PressThrough::Mode::ranges) {
        shown.ranges = bands;
    }
    return shown;
}

}  // namespace palpate::viewer
