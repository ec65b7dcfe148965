// Straight motion through the lattice, whatever field lies on it: where it leaves a tetrahedron,
// and how far it stays out of the grid.
#pragma once

#include <algorithm>

#include "palpate/lattice.hpp"

namespace palpate {

inline constexpr unsigned no_wall = wall_count;

/// How far along a folded direction the first wall is, if nearer than `farthest`. Walls of the mask
/// are left out.
struct Exit {
    double t;
    unsigned wall;
};
inline Exit first_exit(const Vec3& folded, const Vec3& direction, double farthest,
                       unsigned without) {
    Exit exit{farthest, no_wall};
    for (unsigned wall = 0; wall < wall_count; ++wall) {
        const double speed = approach(direction, wall);
        const double room = slack(folded, wall);
        if (speed * exit.t <= room || has(without, wall)) continue;
        const double t = room / speed;
        if (t < exit.t) exit = {t, wall};
    }
    return exit;
}

/// From deep in the background: how much of the motion [0, left] from a point (index space)
/// certainly stays outside the box from `before` to `size` + `behind` on every axis, which has to
/// be half a voxel larger than what is not background. This avoids walking through empty space cell
/// by cell.
inline double stretch_outside(const Vec3& from, const Vec3& displacement, double left,
                              double before, const Index3& size, double behind) {
    double enter = 0;
    double leave = left;
    for (int a = 0; a < 3; ++a) {
        const double low = before - from[a];
        const double high = size[a] + behind - from[a];
        if (displacement[a] == 0) {
            if (low > 0 || high < 0) return left;
            continue;
        }
        const double t0 = low / displacement[a];
        const double t1 = high / displacement[a];
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
    }
    return enter < leave ? enter : left;
}

}  // namespace palpate
