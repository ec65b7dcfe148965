// The figure and the pictures of the experiment penetration.
#pragma once

#include "evaluation/experiment.hpp"
#include "evaluation/penetration/pressing.hpp"

namespace palpate::evaluation {

/// Names of the three ways to press, in the order of lines and strips.
inline constexpr const char* pressing_functions[] = {"off", "threshold", "ranges"};

/// From the table of penetration(): for up to three volumes the level felt, the force and the mode
/// against the hand's depth.
Figure penetration_figure(const Table& table, const std::vector<PressingLine>& lines,
                          const PressingPlan& plan);

/// The surfaces at the line's levels, the hand's line, and the contact in `tick` with its force.
/// Throws io::OutputError if it cannot be drawn; `waiting` may throw to stop.
Picture penetration_picture(const PressingLine& line, const PressingTick& tick, bool quick,
                            const std::function<void()>& waiting);

}  // namespace palpate::evaluation
