// The tools that the instruction counter moves, and how the hands move them.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "palpate/tool_proxy.hpp"

namespace palpate::benchmarks {

/// A body, the level that is felt, a tool, and its pose in the hand in each tick.
struct ToolTouch {
    Field field;
    double isovalue = 0;
    std::shared_ptr<const Tool> tool;
    std::vector<Pose> path;
};

/// A cube of about so many points, half a voxel apart; the hand moves by a tenth of a voxel a tick.
struct ToolCase {
    const char* name;
    ToolTouch (*touch)(int points);
};
/// Hovering over a ball, a corner on it, that corner while the hand turns at 20 rad/s to and fro, a
/// face flat on a plane, through noise.
std::span<const ToolCase> tool_cases();

}  // namespace palpate::benchmarks
