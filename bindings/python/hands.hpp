// The path of a hand, and the surface, method and tool that it feels with, checked as for replay().
// All functions that move a proxy without a device use these.
#pragma once

#include "bindings/python/arrays.hpp"
#include "palpate/io/trajectory.hpp"
#include "palpate/tool.hpp"

namespace palpate::python {

/// Throws std::invalid_argument for what is not finite, no unit quaternion, or has no rows.
io::Trajectory trajectory_from(const Doubles& time, const Doubles& position,
                               const std::optional<Doubles>& orientation);
/// The same of a hand without times.
io::Trajectory poses_from(const Doubles& position, const Doubles& orientation);
/// The same of a point; there may be none.
std::vector<Vec3> hips_from(const Doubles& hips);

/// The level [data units]. Throws std::invalid_argument for one that cannot be felt, and for a
/// method or a tool that is not for this field.
double felt_level(const Field& field, const io::Level& level, const std::string& method,
                  const std::shared_ptr<const Tool>& tool = nullptr);

}  // namespace palpate::python
