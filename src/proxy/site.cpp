// Straight motion from tetrahedron to tetrahedron. docs/lattice.md says why rounding cannot make it
// leave the lattice.
#include "proxy/site.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr unsigned no_wall = wall_count;

/// How far along a folded direction the first wall is, if nearer than `farthest`. Walls of the mask
/// are left out.
struct Exit {
    double t;
    unsigned wall;
};
Exit first_exit(const Vec3& folded, const Vec3& direction, double farthest, unsigned without) {
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

/// From deep in the background: how much of the motion [0, left] certainly stays in it, up to half
/// a voxel before the border of the padded grid. This avoids walking through empty space cell by
/// cell.
double stretch_in_background(const Site& site, const Vec3& displacement, double left) {
    const Vec3 from = index_of(site.point);
    const Index3& size = site.field.geometry().size;
    double enter = 0;
    double leave = left;
    for (int a = 0; a < 3; ++a) {
        const double low = -1.5 - from[a];
        const double high = size[a] + 0.5 - from[a];
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

}  // namespace

void Progress::report_to_observer(StepKind kind, const Site& site, const Vec3& goal_index) const {
    const Vec3 point = physical_from_index(geometry, index_of(site.point));
    const Vec3 goal = physical_from_index(geometry, goal_index);
    observer.on_step(Step{kind, point, goal, site.point.tetrahedron}, observer.context);
}

WalkEnd walk(Site& site, const Vec3& displacement, Progress& progress) {
    Vec3 direction = displacement;
    double left = 1;
    while (progress.budget-- > 0) {
        if (site.field.is_background(site.point.tetrahedron.cell)) {
            const Vec3 along = unfold(site.point.tetrahedron, direction);
            const double t = stretch_in_background(site, along, left);
            if (t > 0) {
                site.move_to(locate(index_of(site.point) + t * along));
                direction = fold(site.point.tetrahedron, along);
                left -= t;
                ++progress.tetrahedra;
                if (left <= 0) return WalkEnd::target;
                continue;
            }
        }
        const Exit exit = first_exit(site.point.folded, direction, left, 0);
        const double slope = site.slope(direction);
        const double room = -site.excess();
        if (slope > 0 && slope * exit.t > room) {
            const double hit = std::max(0.0, room / slope);
            site.point.folded = snap(site.point.folded + hit * direction, 0);
            progress.tetrahedra += hit > 0;
            return WalkEnd::surface;
        }
        progress.tetrahedra += exit.t > 0;
        if (exit.wall == no_wall) {
            site.point.folded = snap(site.point.folded + exit.t * direction, 0);
            return WalkEnd::target;
        }
        site.point.folded = snap(site.point.folded + exit.t * direction, 1U << exit.wall);
        progress.report(StepKind::cross, site);
        site.cross(exit.wall);
        direction = reflect(direction, exit.wall);
        left -= exit.t;
    }
    return WalkEnd::out_of_budget;
}

bool slide(Site& site, const Vec3& step, unsigned on, unsigned walls, Progress& progress) {
    --progress.budget;
    const Vec3 from = site.point.folded;
    const Exit exit = first_exit(from, step, 1.0, on);
    const unsigned met = exit.wall == no_wall ? 0U : 1U << exit.wall;
    site.point.folded = snap(from + exit.t * step, walls | met);
    progress.tetrahedra += exit.t > 0;
    return met == 0;
}

}  // namespace palpate
