// Straight motion from tetrahedron to tetrahedron. docs/lattice.md says why rounding cannot make it
// leave the lattice.
#include "proxy/site.hpp"

#include "proxy/straight.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

void Progress::report_to_observer(StepKind kind, const Vec3& index, const Tetrahedron& tetrahedron,
                                  const Vec3& goal_index) const {
    const Vec3 point = physical_from_index(geometry, index);
    const Vec3 goal = physical_from_index(geometry, goal_index);
    observer.on_step(Step{kind, point, goal, tetrahedron}, observer.context);
}

WalkEnd walk(Site& site, const Vec3& displacement, Progress& progress) {
    Vec3 direction = displacement;
    double left = 1;
    while (progress.budget-- > 0) {
        if (site.field.is_background(site.point.tetrahedron.cell)) {
            const Vec3 along = unfold(site.point.tetrahedron, direction);
            const double t = stretch_outside(index_of(site.point), along, left, -1.5,
                                             site.field.geometry().size, 0.5);
            if (t > 0) {
                site.move_to(locate(index_of(site.point) + t * along));
                direction = fold(site.point.tetrahedron, along);
                left -= t;
                ++progress.tetrahedra;
                if (left <= 0 || left < progress.least_left) return WalkEnd::target;
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
        if (-slope * exit.t > site.thickness - room) {
            const double hit = std::max(0.0, (site.thickness - room) / -slope);
            site.point.folded = snap(site.point.folded + hit * direction, 0);
            progress.tetrahedra += hit > 0;
            site.turn();
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
        if (left < progress.least_left) return WalkEnd::target;
    }
    return WalkEnd::out_of_budget;
}

bool slide(Site& site, const Vec3& step, unsigned on, unsigned walls, Progress& progress) {
    --progress.budget;
    const Vec3 from = site.point.folded;
    const Exit exit = first_exit(from, step, 1.0, on);
    // A slide along walls falls from the surface, and in a layer may fall on the other one.
    if (site.is_layer()) {
        const double fall = -site.slope(step), room = site.thickness + site.excess();
        if (fall * exit.t > room) {
            site.point.folded = snap(from + std::max(0.0, room / fall) * step, walls);
            ++progress.tetrahedra;
            site.turn();
            return false;
        }
    }
    const unsigned met = exit.wall == no_wall ? 0U : 1U << exit.wall;
    site.point.folded = snap(from + exit.t * step, walls | met);
    progress.tetrahedra += exit.t > 0;
    return met == 0;
}

}  // namespace palpate
