// A heart-like shell that beats: two thick-walled chambers that contract, as a function of the
// phase. Analytic and smooth in space and time; the core only. See docs/scenes.md.
#pragma once

#include "palpate/scenes/volumes.hpp"

namespace palpate::scenes {

inline constexpr int beating_frames = 20;      ///< of one beat, evenly spaced
inline constexpr double beating_period = 0.8;  ///< [s] of one beat
inline constexpr double beating_length = 100;  ///< [mm] the longest axis of beating_grid()

/// The grid of "synthetic:beating": beating_length along its longest axis, physical centre 0.
Geometry beating_grid(const Index3& size = {64, 64, 64});

/// The density, 0..1, at a point [mm, from the grid's centre, in its axes]. The heart fits into a
/// cube of `length` [mm]. The density is 1 in the middle of the walls and falls linearly to 0 on
/// both sides. Phase 0 (and 1) is the fullest, about 0.4 the emptiest; any real number.
double beating_density(const Vec3& point, double phase, double length = beating_length);

/// The scene at a phase of the beat.
Scene beating_frame(const Geometry& geometry, double phase, SampleType type = SampleType::uint8,
                    const OnProgress& progress = {});
Scene beating_frame(const Index3& size, double phase, SampleType type = SampleType::uint8);

}  // namespace palpate::scenes
