// Deterministic motions of a hand over any field: they look for the surface themselves.
// Shared by tests, benchmarks, evaluation and demo. The core only. See docs/scenes.md.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/field.hpp"

namespace palpate::scenes {

struct MotionSettings {
    double rate_hz = 1000;   ///< samples per second. The device's rate
    double duration_s = 10;  ///< t runs from 0 to this
    double speed_mm_s = 50;  ///< never above it (but for random). 50 is a hand at ease
    double depth_mm = 2;     ///< how deep the hand presses below the surface, >= 0
    std::uint64_t seed = 1;  ///< chooses the start, the directions and their order
};

struct HandSample {
    double t = 0;                  ///< [s]
    Vec3 position = Vec3::Zero();  ///< [mm, physical]
};

/// approach, press, slide, circle, tap, explore, random.
std::vector<std::string> motion_names();

/// round(duration_s * rate_hz) + 1 samples at t = i / rate_hz: where the hand (HIP) is.
///
/// Speed: no step is longer than speed_mm_s / rate_hz, and position and velocity are continuous;
/// only `random` jumps. Depth: along the surface's normal, as far as the field shows one.
/// If no surface is found (isovalue beyond the data), the hand moves around the grid's centre.
/// A motion needs about 0.2 s + depth_mm / speed_mm_s before it is at depth. A shorter one ends
/// on its way.
/// Same arguments, same bits, on every compiler (no libm beyond sqrt).
/// `progress` is called repeatedly with the part that is done, and may throw to stop. Throws
/// std::invalid_argument listing the names, or saying which setting is not usable.
std::vector<HandSample> make_motion(std::string_view name, const Field& field, double isovalue,
                                    const MotionSettings& settings = {},
                                    const OnProgress& progress = {});

}  // namespace palpate::scenes
