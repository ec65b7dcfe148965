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

    /// As a mask.
    unsigned walls() const { return wall == no_wall ? 0 : 1U << wall; }
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

/// Which part of the motion [0, left] from a point (index space) is in the box from `before` to
/// `size` + `behind` on every axis; enter > leave: none.
struct Stay {
    double enter, leave;
};
inline Stay stay_in_box(const Vec3& from, const Vec3& displacement, double left, double before,
                        const Index3& size, double behind) {
    Stay stay{0, left};
    for (int a = 0; a < 3; ++a) {
        const double low = before - from[a];
        const double high = size[a] + behind - from[a];
        if (displacement[a] == 0) {
            if (low > 0 || high < 0) return {1, 0};
            continue;
        }
        const double t0 = low / displacement[a];
        const double t1 = high / displacement[a];
        stay.enter = std::max(stay.enter, std::min(t0, t1));
        stay.leave = std::min(stay.leave, std::max(t0, t1));
    }
    return stay;
}

/// From deep in the background: how much of the motion certainly stays outside that box, which has
/// to be half a voxel larger than what is not background. This avoids walking through empty space
/// cell by cell.
inline double stretch_outside(const Vec3& from, const Vec3& displacement, double left,
                              double before, const Index3& size, double behind) {
    const Stay stay = stay_in_box(from, displacement, left, before, size, behind);
    return stay.enter < stay.leave ? stay.enter : left;
}

enum class WalkEnd { target, surface, out_of_budget };

/// How a straight walk ended, and which part of it was left then.
struct Walked {
    WalkEnd end;
    double left;
};

/// Goes straight along `direction` (folded, voxel) from tetrahedron to tetrahedron: the one walk of
/// points and tools on either field. What it meets, counts and may pass over a course says:
/// spend() is false without budget; skip() gives the part of the way ahead that needs no look;
/// advance() goes to an exit, or gives the part of the way there at which the surface is met;
/// crossed() is told of each wall, and is_enough() of what is left.
template <class AnySite, class Course>
[[gnu::always_inline]] inline Walked walk_straight(AnySite& site, Vec3 direction, Course&& course) {
    double left = 1;
    while (course.spend()) {
        if (const double t = course.skip(site, direction, left); t > 0) {
            const Vec3 along = unfold(site.point.tetrahedron, direction);
            site.move_to(AnySite::located(site.index() + t * along));
            direction = fold(site.point.tetrahedron, along);
            left -= t;
            if (left <= 0 || course.is_enough(left)) return {WalkEnd::target, 0};
            continue;
        }
        const Exit exit = first_exit(site.point.folded, direction, left, 0);
        const bool at_wall = exit.wall != no_wall;
        if (const auto met = course.advance(site, exit, direction)) {
            return {WalkEnd::surface, left - *met};
        }
        if (!at_wall) return {WalkEnd::target, 0};
        course.crossed(site, exit.wall);
        direction = reflect(direction, exit.wall);
        left -= exit.t;
        if (course.is_enough(left)) return {WalkEnd::target, 0};
    }
    return {WalkEnd::out_of_budget, left};
}

}  // namespace palpate
