// Recovery: out of the solid after the isovalue or the field changed, or when a session starts
// inside. See docs/proxy.md, "Recovery".
#include <algorithm>
#include <cmath>

#include "proxy/cone.hpp"
#include "proxy/update.hpp"

namespace palpate {
namespace {

/// Steepest descent among the incident tetrahedra: a step in folded mm whose length is the slope
/// [data units / mm] and the walls that hold it.
struct Descent {
    Tetrahedron tetrahedron;
    Vec3 step_mm = Vec3::Zero();
    unsigned walls = 0;
    double slope_squared = 0;
};

Descent steepest_descent(const Site& site) {
    const unsigned on = walls_at(site.point.folded);
    Descent best;
    for_each_incident(site.point, [&](const Tetrahedron& t) {
        const Vec3 per_mm = fold_lengths(t, site.field.voxels_per_mm());
        WalledCone cone(on, per_mm);
        const Vec3 down = -site.excess_gradient_in(t).cwiseProduct(per_mm);
        const ConeProjection projection = project_on_cone(down, cone.half_spaces);
        const double slope_squared = dot(projection.point, projection.point);
        if (slope_squared > best.slope_squared) {
            best = {t, projection.point, cone.walls_of(projection), slope_squared};
        }
        return false;
    });
    return best;
}

/// Descends until out (true), stuck on a plateau or in a local minimum, or out of budget.
bool descend_out(Site& site, Course& course) {
    const double tolerance = site.field.tolerance();
    const double flat = tolerance / course.geometry.spacing.maxCoeff();
    while (course.budget > 0) {
        const double excess = site.excess();
        if (!(excess > tolerance)) return true;
        const Descent descent = steepest_descent(site);
        if (!(descent.slope_squared > flat * flat)) return false;
        site.enter(descent.tetrahedron);
        const Vec3 per_mm = fold_lengths(descent.tetrahedron, site.field.voxels_per_mm());
        // Along the step the excess falls by slope^2 per unit: it is gone at excess / slope^2.
        const Vec3 step = descent.step_mm.cwiseProduct(per_mm) * (excess / descent.slope_squared);
        slide(site, step, walls_at(site.point.folded), descent.walls, course);
        course.report(StepKind::recover, site);
    }
    return false;
}

constexpr double thickest_shell = 16;    // [voxel] searched along each direction at a time
constexpr double thinnest_shell = 0.25;  // needs a budget of some 100 pieces

/// A shell that the budget lasts for along all 26 directions (fewer than 8 walls a voxel, and two
/// pieces a probe): one that is given up half way would be begun again by every later update.
double shell_within(int budget) {
    return std::min(thickest_shell, (budget / 26 - 2) / 8.0);
}

/// Looks for free space along 26 directions, a shell at a time. True when found and moved to.
bool search_out(Site& site, Course& course, double& reach) {
    const Index3& size = site.field.geometry().size;
    const double farthest = 2 * size.cast<double>().norm() + 4 * thickest_shell;
    const Vec3 from = index_of(site.point);
    const Vec3& spacing = course.geometry.spacing;
    const double unit = spacing.minCoeff();
    while (reach * unit <= farthest * spacing.maxCoeff()) {
        const double shell_thickness = shell_within(course.budget);
        if (shell_thickness < thinnest_shell) return false;
        LatticePoint nearest;
        double least = std::numeric_limits<double>::infinity();
        for (int direction = 0; direction < 27; ++direction) {
            const Vec3 axes(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1);
            if (direction == 13) continue;
            const Vec3 per_unit = (axes / std::sqrt(dot(axes, axes))).cwiseQuotient(spacing) * unit;
            const Vec3 start = from + reach * per_unit;
            // The solid is the free side of the field with its sign turned.
            Site probe(site.field, site.isovalue, -site.sign, locate(start));
            Course silent{course.geometry, {}, start, course.budget};
            const bool free_already = probe.excess() >= 0;
            const WalkEnd end =
                free_already
                    ? WalkEnd::surface
                    : walk(probe, fold(probe.point.tetrahedron, per_unit * shell_thickness),
                           silent);
            course.budget = silent.budget;
            if (end != WalkEnd::surface) continue;
            const Vec3 way = (index_of(probe.point) - from).cwiseProduct(spacing);
            if (dot(way, way) >= least) continue;
            least = dot(way, way);
            nearest = probe.point;
        }
        if (std::isfinite(least)) {
            site.move_to(nearest);
            course.report(StepKind::recover, site);
            return true;
        }
        reach += shell_thickness;
    }
    reach = 0;  // nowhere free: look again in the next update
    return false;
}

}  // namespace

bool recover(Site& site, Course& course, double& reach) {
    if (reach == 0 && descend_out(site, course)) return true;
    if (course.budget <= 0) return false;
    if (!search_out(site, course, reach)) return false;
    reach = 0;
    return true;
}

}  // namespace palpate
