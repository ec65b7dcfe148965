// The force along a stroke of the hand through layers, by depth: from the first contact on, until
// the hand has left all layers for a while.
#pragma once

#include <vector>

#include "palpate/servo.hpp"

namespace palpate::viewer {

class Stroke {
  public:
    struct Point {
        double depth = 0;  ///< [mm, physical] of the hand along the stroke, from its first contact
        double force = 0;  ///< [N]
        int layer = -1;    ///< that is touched; -1: none
    };
    static constexpr std::size_t most_points = 20'000;
    static constexpr double pause = 2;  ///< [s] outside of all layers, after which another begins

    /// Takes a snapshot of a session with layers. True if the points have changed. The time of a
    /// recording that is played may jump: then the stroke begins anew.
    bool add(const Snapshot& now);
    void clear() { *this = {}; }
    const std::vector<Point>& points() const { return points_; }

  private:
    std::vector<Point> points_;
    Vec3 origin_ = Vec3::Zero();  // [mm, physical] the first contact
    Vec3 into_ = Vec3::Zero();    // unit, physical axes, into the solid
    double time_ = 0;             // [s] of the last tick
    double inside_at_ = 0;        // [s] when layers were felt last
    bool begun_ = false;
};

}  // namespace palpate::viewer
