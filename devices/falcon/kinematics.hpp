// The Falcon's mechanics: three legs, each a motor's arm and a parallelogram, after Stamper 1997.
// Positions [m] in the legs' frame: x to the right, y up, z out of the device. Angles [rad] and
// torques [N m] are those of the arms.
#pragma once

#include <optional>

#include "palpate/volume.hpp"

namespace palpate::devices::falcon {

/// Middle of the workspace [m]: a cube of 80 mm about it can be reached.
inline const Vec3 centre(0, 0, 0.12);

/// Angles of the three arms at a position. None where a leg cannot reach.
std::optional<Vec3> angles_at(const Vec3& position);

/// The change of the angles with the position [rad/m]: row i is the gradient of angle i. None where
/// a leg cannot reach, or is stretched so that its angle says nothing of the position.
std::optional<Mat3> angle_gradients(const Vec3& position);

/// The position with these angles, by Newton's method from `start`. None where it is not found to
/// a micrometre in a bounded number of steps.
std::optional<Vec3> position_with(const Vec3& angles, const Vec3& start);

/// The torques that give a force [N] there: the same power for every motion. None as above.
std::optional<Vec3> torques_for(const Vec3& force, const Vec3& position);

/// [rad] of the arms for what their encoders count, 0 where the device was homed.
Vec3 angles_from(const Eigen::Vector3i& encoders);
/// The nearest counts to these angles.
Eigen::Vector3i encoders_at(const Vec3& angles);

}  // namespace palpate::devices::falcon
