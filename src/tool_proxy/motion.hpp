// Certified motion of a whole tool: from a pose to another, as far as none of its points is
// blocked.
#pragma once

#include "tool_proxy/around.hpp"

namespace palpate::tool {

/// The tool while an update runs.
struct Motion {
    ToolProxy& proxy;
    Around& around;
    PoseObserver observer;
    int hit = -1;  ///< the point that ended the last motion; -1: none

    /// Goes towards the pose that a translation [mm] and a rotation vector [rad] lead to; returns
    /// how far, from 0 to 1. With `exact`, that pose is the end. Small rotations only: chords are
    /// straight. If the budget ends, the tool has not moved, and the rest of the test is left for
    /// go_on() (Kept::pass).
    double go(const Vec3& translation, const Vec3& rotation, const Pose* exact = nullptr);
    /// Continues the test of such a motion in a later update.
    double go_on();
    /// The farthest pose to which that motion may lead.
    Pose end() const { return pose_at(proxy.kept().pass.part); }

  private:
    double test_points();
    Pose pose_at(double part) const;
    double free_part_of(int point, const Pose& to, double level);
    /// Puts the tool there; the odometers then say so.
    void arrive(const Pose& at, double moved, double turned);
};

/// The pose after a part of a motion.
inline Pose moved(const Pose& pose, const Vec3& translation, const Vec3& rotation, double part) {
    return {pose.position + part * translation, turned(pose.orientation, part * rotation)};
}

}  // namespace palpate::tool
