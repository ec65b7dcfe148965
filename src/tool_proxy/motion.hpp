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
    /// Points that ended the last motion.
    std::array<int, 8> hits{};
    int hit_count = 0;

    /// Goes towards the pose that a translation [mm] and a rotation vector [rad] lead to; returns
    /// how far, from 0 to 1. With `exact`, that pose is the end. Small rotations only: chords are
    /// straight.
    double go(const Vec3& translation, const Vec3& rotation, const Pose* exact = nullptr);

  private:
    double free_part_of(int point, const Pose& to, double level);
    /// Below 0: none.
    void hit(int point);
    /// Puts the tool there; the odometers then say so.
    void arrive(const Pose& at, double moved, double turned);
};

/// The pose after a part of a motion.
inline Pose moved(const Pose& pose, const Vec3& translation, const Vec3& rotation, double part) {
    return {pose.position + part * translation, turned(pose.orientation, part * rotation)};
}

}  // namespace palpate::tool
