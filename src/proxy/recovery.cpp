// Recovery: brings the proxy out of the solid after the isovalue or the field changed, or when a
// session starts inside. See docs/proxy.md, "Recovery".
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
    int work = 0;
};

Descent steepest_descent(const Site& site) {
    const unsigned on = walls_at(site.point.folded);
    Descent best;
    for_each_incident(site.point, [&](const Tetrahedron& t) {
        const Vec3 per_mm = fold_lengths(t, site.field.voxels_per_mm());
        WalledCone cone(on, per_mm);
        const Vec3 down = -site.excess_gradient_in(t).cwiseProduct(per_mm);
        const ConeProjection projection = project_on_cone(down, cone.half_spaces);
        best.work += work_of_projection;
        const double slope_squared = dot(projection.point, projection.point);
        if (slope_squared > best.slope_squared) {
            best = {t, projection.point, cone.walls_of(projection), slope_squared, best.work};
        }
        return false;
    });
    return best;
}

/// Far more than crosses any tetrahedron, so it changes no step; but where the isovalue lies
/// absurdly far from the data, the quotient would overflow.
constexpr double most_of_step = 1e100;

/// Descends until out (true), stuck on a plateau or in a local minimum, or out of budget.
bool descend_out(Site& site, Progress& progress) {
    const double tolerance = site.field.tolerance();
    const double flat = tolerance / progress.geometry.spacing.maxCoeff();
    while (progress.budget > 0) {
        const double excess = site.excess();
        if (!(excess > tolerance)) return true;
        const Descent descent = steepest_descent(site);
        progress.charge(descent.work);
        if (!(descent.slope_squared > flat * flat)) return false;
        site.enter(descent.tetrahedron);
        const Vec3 per_mm = fold_lengths(descent.tetrahedron, site.field.voxels_per_mm());
        // Along the step the excess falls by slope^2 per unit: it is zero at excess / slope^2.
        const double share = std::min(excess / descent.slope_squared, most_of_step);
        const Vec3 step = descent.step_mm.cwiseProduct(per_mm) * share;
        slide(site, step, walls_at(site.point.folded), descent.walls, progress);
        progress.report(StepKind::recover, site);
    }
    return false;
}

/// The same on the smooth field, along its gradient: at most a quarter of a voxel at a time, and
/// only while the excess falls. Uses half of the budget, because the search is faster along a
/// valley or where the slope is tiny.
bool descend_out(CubicSite& site, Progress& progress) {
    const double shortest = progress.geometry.spacing.minCoeff();
    constexpr double farthest = 64;  // [voxel] to where such a slope would lead out
    const int for_search = progress.budget / 2;
    while (progress.budget > for_search) {
        const double excess = site.excess();
        if (!(excess > site.level())) return true;
        const Tetrahedron& t = site.point.tetrahedron;
        const Vec3 per_mm = fold_lengths(t, site.field.voxels_per_mm());
        const Vec3 gradient = site.here().gradient.cwiseProduct(per_mm);
        const double slope = std::sqrt(dot(gradient, gradient));
        if (!(slope * farthest * shortest > excess)) return false;
        const CubicSite before = site;
        const Vec3 from = site.index();
        const Vec3 down = unfold(t, (gradient * (-1 / slope)).cwiseProduct(per_mm));
        double length = std::min((excess - 0.5 * site.level()) / slope, 0.25 * shortest);
        bool falls = false;
        do {
            if (--progress.budget <= for_search || !(length > 1e-9 * shortest)) {
                site.return_to(before);  // not to a trial, which may lie deeper
                return false;
            }
            site.move_to(cubic::locate(from + length * down));
            length *= 0.5;
            falls = site.excess() < excess;
            progress.charge(site.take_work());
        } while (!falls);
        ++progress.tetrahedra;
        progress.report(StepKind::recover, site);
    }
    return false;
}

constexpr double thickest_shell = 16;      // [voxel] searched along each direction at a time
constexpr double thinnest_shell = 0.25;    // searched in each update, whatever its budget
constexpr double rounding_of_part = 1e-6;  // of a shell's thickness; far more than rounding is

/// How thick a shell the budget can search along all 26 directions (fewer than 8 walls a voxel, and
/// two pieces a probe). Without this, every later update would start the same shell and abandon it.
double shell_within(int budget, int work_of_step) {
    return std::min(thickest_shell, (budget / (26 * work_of_step) - 2) / 8.0);
}

/// Searches 26 directions for free space, one shell at a time. If it finds some, it moves there and
/// returns true.
template <class AnySite>
bool search_out(AnySite& site, Progress& progress, double& reach) {
    const Index3& size = site.field.geometry().size;
    const double farthest = 2 * size.cast<double>().norm() + 4 * thickest_shell;
    const Vec3 from = site.index();
    const Vec3& spacing = progress.geometry.spacing;
    const double unit = spacing.minCoeff();
    constexpr int most = std::numeric_limits<int>::max() / 2;  // a shell ends by its thickness
    bool searched = false;
    while (reach * unit <= farthest * spacing.maxCoeff()) {
        double shell_thickness = shell_within(progress.budget, AnySite::work_of_step(site.field));
        if (shell_thickness < thinnest_shell) {
            if (searched) return false;
            shell_thickness = thinnest_shell;
        }
        searched = true;
        LatticePoint nearest;
        double least = std::numeric_limits<double>::infinity();
        for (int direction = 0; direction < 27; ++direction) {
            const Vec3 axes(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1);
            if (direction == 13) continue;
            const Vec3 per_unit = (axes / std::sqrt(dot(axes, axes))).cwiseQuotient(spacing) * unit;
            const Vec3 start = from + reach * per_unit;
            AnySite probe = turned_at(site, start);
            Progress silent{progress.geometry, {}, start, most};
            // Stops at the distance of the nearest point that another direction has found.
            silent.least_left =
                1 - (std::sqrt(least) / unit - reach) / shell_thickness - rounding_of_part;
            const bool free_already = probe.excess() >= -site.level();
            const WalkEnd end = free_already ? WalkEnd::surface
                                             : walk_out(probe, per_unit * shell_thickness, silent);
            silent.charge(1 + probe.take_work());
            progress.budget -= most - silent.budget;
            if (end != WalkEnd::surface) continue;
            const Vec3 found = (probe.index() - from).cwiseProduct(spacing);
            if (dot(found, found) >= least) continue;
            least = dot(found, found);
            nearest = probe.point;
        }
        if (std::isfinite(least)) {
            site.move_to(nearest);
            progress.report(StepKind::recover, site);
            return true;
        }
        reach += shell_thickness;
    }
    reach = 0;  // nowhere free: look again in the next update
    return false;
}

}  // namespace

template <class AnySite>
bool recover(AnySite& site, Progress& progress, double& reach) {
    if (reach == 0 && descend_out(site, progress)) return true;
    if (progress.budget <= 0) return false;
    if (!search_out(site, progress, reach)) return false;
    reach = 0;
    return true;
}

template bool recover(Site&, Progress&, double&);
template bool recover(CubicSite&, Progress&, double&);

}  // namespace palpate
