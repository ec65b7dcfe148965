// How far a hand may draw the proxy where not all samples are in memory
// (samples.hpp), so that no update looks at one that is not. See docs/streaming.md.
#pragma once

#include "palpate/field.hpp"

namespace palpate {

/// From where and to where a proxy is drawn.
struct Pull {
    Vec3 from = Vec3::Zero();  ///< proxy [mm, physical]
    Vec3 to = Vec3::Zero();    ///< hand [mm, physical]
    double turn = 0;           ///< of a tool: its rotation times its gyration [mm]
    double arm = 0;            ///< of a tool: its farthest point from its reference point [mm]
};

/// The part of the pull, 1, 1/2, ... or 0, that needs only samples that are in memory. The least
/// that is tried is 1/64, or a voxel of a long pull. An update never comes farther from its goal
/// than it was (G4, T4), so all that it looks at lies in a ball round the goal. If the proxy rests
/// on a surface, a part of the pull finds the same place. 1 where all samples are in memory.
/// Neither allocates nor throws.
double part_within_reach(const Field& field, const Pull& pull) noexcept;

}  // namespace palpate
