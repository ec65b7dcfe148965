// Straight motion from tetrahedron to tetrahedron. docs/lattice.md says why rounding cannot make it
// leave the lattice.
#include "proxy/site.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate {

void Progress::report_to_observer(StepKind kind, const Vec3& index, const Tetrahedron& tetrahedron,
                                  const Vec3& goal_index) const {
    const Vec3 point = physical_from_index(geometry, index);
    const Vec3 goal = physical_from_index(geometry, goal_index);
    observer.on_step(Step{kind, point, goal, tetrahedron}, observer.context);
}

namespace {

/// On the linear field, where the surface is met at a quotient.
struct LinearCourse : PointCourse {
    double skip(const Site& site, const Vec3& direction, double left) {
        if (!site.field.is_background(site.point.tetrahedron.cell)) return 0;
        const double t =
            stretch_outside(index_of(site.point), unfold(site.point.tetrahedron, direction), left,
                            -1.5, site.field.geometry().size, 0.5);
        progress.tetrahedra += t > 0;
        return t;
    }
    std::optional<double> advance(Site& site, const Exit& exit, const Vec3& direction) {
        const double slope = site.slope(direction);
        const double room = -site.excess();
        const bool ahead = slope > 0 && slope * exit.t > room;
        if (ahead || -slope * exit.t > site.thickness - room) {
            const double hit =
                std::max(0.0, ahead ? room / slope : (site.thickness - room) / -slope);
            site.point.folded = snap(site.point.folded + hit * direction, 0);
            progress.tetrahedra += hit > 0;
            if (!ahead) site.turn();
            return hit;
        }
        progress.tetrahedra += exit.t > 0;
        site.point.folded = snap(site.point.folded + exit.t * direction, exit.walls());
        return std::nullopt;
    }
    void crossed(Site& site, unsigned wall) {
        progress.report(StepKind::cross, site);
        site.cross(wall);
    }
};

}  // namespace

WalkEnd walk(Site& site, const Vec3& displacement, Progress& progress) {
    return walk_straight(site, displacement, LinearCourse{{progress}}).end;
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
    site.point.folded = snap(from + exit.t * step, walls | exit.walls());
    progress.tetrahedra += exit.t > 0;
    return exit.wall == no_wall;
}

}  // namespace palpate
