// The figure and the pictures of the experiment penetration.
#pragma once

#include "evaluation/experiment.hpp"
#include "evaluation/penetration/course.hpp"

namespace palpate::evaluation {

/// Names of the three ways to press, in the order of lines and strips.
inline constexpr const char* pressing_functions[] = {"off", "threshold", "ranges"};

/// From the table of penetration(): for up to three volumes the level felt, the force and the mode
/// against the hand's depth.
Figure penetration_figure(const Table& table, const std::vector<PressingCourse>& courses,
                          const PressingPlan& plan);

/// The surfaces at the course's levels, the hand's line, and the contact in `tick` with its force.
/// Throws io::OutputError if it cannot be drawn; `waiting` may throw to stop.
Picture penetration_picture(const PressingCourse& course, const PressingTick& tick, bool quick,
                            const std::function<void()>& waiting);

}  // namespace palpate::evaluation
