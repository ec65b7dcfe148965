// Method exact: descent over the union of the incident tetrahedra's free cones (docs/proxy.md).
#include <cmath>
#include <optional>
#include <utility>

#include "proxy/cone.hpp"
#include "proxy/update.hpp"

namespace palpate {
namespace {

/// A move that brings the SCP closer to its target, in one of its incident tetrahedra.
struct Move {
    Tetrahedron tetrahedron;
    Vec3 step = Vec3::Zero();  ///< folded [voxel]
    unsigned walls = 0;        ///< the SCP stays on these
    double gain = 0;           ///< |step|^2 [mm^2]: by how much the squared distance can fall
    bool straight = false;     ///< the way to the target itself is free here
};

/// The move of an SCP that is on no wall, by far the most frequent case: one plane at most.
/// h is the way to the target (folded, voxel).
Move move_inside(const Site& site, bool contact, const Vec3& h) {
    const Tetrahedron& t = site.point.tetrahedron;
    const Vec3 g = site.sign * site.piece.gradient;
    const double into = dot(g, h);
    if (!contact || into <= 0) return {.tetrahedron = t, .step = h, .straight = true};
    const Vec3 mm = fold_lengths(t, site.field.geometry().spacing);
    const Vec3 per_mm = fold_lengths(t, site.field.voxels_per_mm());
    // The normal in mm is g per_mm, and so is the way back to voxels: per_mm twice.
    const Vec3 n = g.cwiseProduct(per_mm).cwiseProduct(per_mm);
    const Vec3 step = h - n * (into / dot(g, n));
    const Vec3 step_mm = step.cwiseProduct(mm);
    return {.tetrahedron = t, .step = step, .gain = dot(step_mm, step_mm)};
}

/// The best move inside one of several incident tetrahedra: h (in its frame) projected on the cone
/// of the walls that the SCP is on and, in contact, the isosurface with gradient g of the excess.
Move move_in(const Tetrahedron& t, const Vec3& g, unsigned on, bool contact, const Vec3& h,
             const Field& field) {
    const bool constrained = contact && (g[0] != 0 || g[1] != 0 || g[2] != 0);
    bool inside = !constrained || dot(g, h) <= 0;
    // Wall by wall the sign of `approach` is exact, so every direction has a tetrahedron that takes
    // it: no gap opens between neighbours.
    for (unsigned w = 0; w < wall_count; ++w) {
        if (has(on, w)) inside &= approach(h, w) <= 0;
    }
    const Vec3 mm = fold_lengths(t, field.geometry().spacing);
    const Vec3 per_mm = fold_lengths(t, field.voxels_per_mm());
    const Vec3 h_mm = h.cwiseProduct(mm);
    if (inside) return {t, h, 0, dot(h_mm, h_mm), true};
    WalledCone cone(on, per_mm);
    if (constrained) cone.half_spaces.add(g.cwiseProduct(per_mm));
    const ConeProjection projection = project_on_cone(h_mm, cone.half_spaces);
    return {t, projection.point.cwiseProduct(per_mm), cone.walls_of(projection),
            dot(projection.point, projection.point)};
}

/// The best move among all incident tetrahedra of an SCP that is on these walls; h is the way to
/// the target (folded, voxel).
Move best_move(const Site& site, unsigned on, bool contact, const Vec3& h) {
    if (on == 0) return move_inside(site, contact, h);
    const Tetrahedron& own = site.point.tetrahedron;
    Move best = move_in(own, site.sign * site.piece.gradient, on, contact, h, site.field);
    if (best.straight) return best;
    const Vec3 h_index = unfold(own, h);
    bool first = true;
    for_each_incident(site.point, [&](const Tetrahedron& t) {
        if (std::exchange(first, false)) return false;  // its own is done
        const Move move =
            move_in(t, site.excess_gradient_in(t), on, contact, fold(t, h_index), site.field);
        if (move.straight || move.gain > best.gain) best = move;
        return best.straight;
    });
    return best;
}

/// Gains below this are rounding [mm^2 per mm^2 of the smallest voxel].
constexpr double least_gain = 1e-18;

/// Pulls the target back against the way the SCP wants to slide, so that it ends up trailing the
/// hand at the friction angle. False if the SCP sticks. The move is h projected on the free cone:
/// its length is the tangential pull, what is left of h the normal pull, on ridges and corners too.
bool apply_friction(const Friction& friction, Proxy& proxy, const Site& site, const Move& move,
                    Course& course) {
    const Vec3 h = course.to_target(site).cwiseProduct(course.geometry.spacing);
    const Vec3 s = fold_lengths(move.tetrahedron, course.geometry.spacing);
    const Vec3 tangential = unfold(move.tetrahedron, move.step.cwiseProduct(s));
    const Vec3 normal = h - tangential;
    const double t = std::sqrt(dot(tangential, tangential));
    const double n = std::sqrt(dot(normal, normal));
    const double mu = proxy.sliding ? friction.dynamic_coefficient : friction.static_coefficient;
    proxy.sliding = t > mu * n;
    if (!proxy.sliding) return false;
    const double back = friction.dynamic_coefficient * n / t;
    course.target -= (tangential * (back < 1 ? back : 1)).cwiseQuotient(course.geometry.spacing);
    return true;
}

/// Rounding leaves an SCP beside the vertex or edge that it slid to, where it does not see all the
/// tetrahedra of that corner and rests behind a bump as low as rounding. So before it rests it
/// looks from the corner of the walls nearer than this [voxel]; f changes by at most 4 ranges a
/// voxel, so going there keeps G1 and G2.
constexpr double hair = 1e-10;
/// What it must gain there; much more than going there can cost, so that it cannot go in circles.
constexpr double least_corner_gain = 1e-12;

/// Puts the SCP on the walls that it is within a hair of, if it can go on from there.
std::optional<Move> move_from_corner(Site& site, const Course& course, double enough) {
    unsigned near = 0;
    for (unsigned w = 0; w < wall_count; ++w) {
        near |= unsigned(slack(site.point.folded, w) <= hair) << w;
    }
    if (near == walls_at(site.point.folded)) return std::nullopt;
    Site corner = site;
    corner.point.folded = snap(site.point.folded, near);
    const unsigned on = walls_at(corner.point.folded);
    const Move move = best_move(corner, on, true, course.folded_to_target(corner));
    if (!(move.gain > enough)) return std::nullopt;
    site.point = corner.point;
    return move;
}

Rest descend(Site& site, Course& course, const Friction& friction, Proxy& proxy) {
    const Vec3& spacing = course.geometry.spacing;
    const double shortest = spacing.minCoeff();
    const double enough = least_gain * shortest * shortest;
    const double enough_at_corner = least_corner_gain * shortest * shortest;
    std::optional<Move> from_corner;
    const Vec3 hip = course.target;
    bool friction_pending = friction.static_coefficient > 0 || friction.dynamic_coefficient > 0;
    while (course.budget > 0) {
        const unsigned on = walls_at(site.point.folded);
        const bool contact = site.excess() >= -site.field.tolerance();
        const Move move = from_corner ? *from_corner
                                      : best_move(site, on, contact, course.folded_to_target(site));
        from_corner.reset();
        if (move.straight) {
            if (on != 0) site.enter(move.tetrahedron);
            const WalkEnd end = walk(site, move.step, course);
            course.report(StepKind::free_move, site);
            if (end != WalkEnd::target) continue;
            if (course.target == hip) return Rest::at_target;
            // Friction pulled the target back to where nothing is touched: there it holds nothing.
            course.target = hip;
            friction_pending = true;
            continue;
        }
        if (friction_pending) {
            friction_pending = false;
            if (!apply_friction(friction, proxy, site, move, course)) return Rest::on_surface;
            continue;
        }
        if (move.gain <= enough) {
            from_corner = move_from_corner(site, course, enough_at_corner);
            if (!from_corner) return Rest::on_surface;
            continue;
        }
        if (on != 0) site.enter(move.tetrahedron);
        const bool at_minimum = slide(site, move.step, on, move.walls, course);
        course.report(StepKind::slide, site);
        // Inside a tetrahedron the minimum over its cone is the minimum: nothing else is incident.
        if (at_minimum && walls_at(site.point.folded) == 0) {
            from_corner = move_from_corner(site, course, enough_at_corner);
            if (!from_corner) return Rest::on_surface;
        }
    }
    return Rest::out_of_budget;
}

}  // namespace

ProxyUpdate update_exact(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings, StepObserver observer) {
    const Vec3 target = index_from_physical(field.geometry(), hip);
    if (!accepts(proxy, target)) return refuse_update(proxy, field, hip);
    Update update(proxy, field, target, settings, observer);
    if (update.recovering) return finish_update(proxy, update, hip, Rest::recovering);
    const Rest rest = descend(update.site, update.course, settings.friction, proxy);
    if (rest == Rest::at_target) proxy.sliding = false;
    return finish_update(proxy, update, hip, rest);
}

}  // namespace palpate
