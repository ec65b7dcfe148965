// Method exact: descent over the union of the incident tetrahedra's free cones (docs/proxy.md).
#include <cmath>

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

/// The best move inside one incident tetrahedron: h projected on the cone of the walls that the SCP
/// is on and, in contact, the isosurface.
Move move_in(const Tetrahedron& t, const LinearPiece& excess, unsigned on, bool contact,
             const Vec3& h_index, const Vec3& spacing) {
    const Vec3 h = fold(t, h_index);
    const Vec3& g = excess.gradient;
    const bool constrained = contact && (g[0] != 0 || g[1] != 0 || g[2] != 0);
    bool inside = !constrained || dot(g, h) <= 0;
    // Wall by wall the sign of `approach` is exact, so every direction has a tetrahedron that takes
    // it: no gap opens between neighbours.
    for (unsigned w = 0; w < wall_count; ++w) {
        if (on >> w & 1) inside &= approach(h, w) <= 0;
    }
    const Vec3 s = fold_lengths(t, spacing);
    const Vec3 h_mm = h.cwiseProduct(s);
    if (inside) return {t, h, 0, dot(h_mm, h_mm), true};

    HalfSpaces<4> cone;
    std::array<unsigned, 4> wall_of{};
    for (unsigned w = 0; w < wall_count; ++w) {
        if (!(on >> w & 1)) continue;
        wall_of[cone.count] = w;
        cone.add(wall_normal(w).cwiseQuotient(s));
    }
    const int walls = cone.count;
    if (constrained) cone.add(g.cwiseQuotient(s));
    const ConeProjection projection = project_on_cone(h_mm, cone);
    Move move{t, projection.point.cwiseQuotient(s), 0, dot(projection.point, projection.point)};
    for (const int a : projection.active) {
        if (a >= 0 && a < walls) move.walls |= 1U << wall_of[a];
    }
    return move;
}

Move best_move(const Site& site, const Vec3& h_index, const Vec3& spacing) {
    const unsigned on = walls_at(site.point.folded);
    const bool contact = site.excess_here() >= -surface_tolerance(site.field);
    Move best = move_in(site.point.tetrahedron, site.excess, on, contact, h_index, spacing);
    if (on == 0 || best.straight) return best;
    const Incident incident = incident_tetrahedra(site.point);
    for (int i = 1; i < incident.count; ++i) {
        const Tetrahedron& t = incident.tetrahedra[i];
        const Move move = move_in(t, site.excess_in(t), on, contact, h_index, spacing);
        if (move.straight) return move;
        if (move.gain > best.gain) best = move;
    }
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

Rest descend(Site& site, Course& course, const Friction& friction, Proxy& proxy) {
    const Vec3& spacing = course.geometry.spacing;
    const double shortest = spacing.minCoeff();
    const double enough = least_gain * shortest * shortest;
    const Vec3 hip = course.target;
    bool friction_pending = friction.static_coefficient > 0 || friction.dynamic_coefficient > 0;
    while (course.budget > 0) {
        const Move move = best_move(site, course.to_target(site), spacing);
        if (move.straight) {
            if (move.tetrahedron.cell != site.point.tetrahedron.cell ||
                !same_tetrahedron(move.tetrahedron, site.point.tetrahedron)) {
                site.enter(move.tetrahedron);
            }
            const WalkEnd end = walk(site, unfold(move.tetrahedron, move.step), course);
            course.report(StepKind::free_move, site);
            if (end == WalkEnd::target) {
                return course.target == hip ? Rest::at_target : Rest::on_surface;
            }
            continue;
        }
        if (friction_pending) {
            friction_pending = false;
            if (!apply_friction(friction, proxy, site, move, course)) return Rest::on_surface;
            continue;
        }
        if (move.gain <= enough) return Rest::on_surface;
        site.enter(move.tetrahedron);
        const bool at_minimum = slide(site, move.step, move.walls, course);
        course.report(StepKind::slide, site);
        // Inside a tetrahedron the minimum over its cone is the minimum: nothing else is incident.
        if (at_minimum && walls_at(site.point.folded) == 0) return Rest::on_surface;
    }
    return Rest::out_of_budget;
}

}  // namespace

ProxyUpdate update_exact(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings, StepObserver observer) {
    Begin begin = begin_update(proxy, field, hip, settings, observer);
    if (!begin.update) return refuse_update(proxy, field, hip);
    Update& update = *begin.update;
    if (begin.recovering) return finish_update(proxy, update, hip, Rest::recovering);
    const Rest rest = descend(update.site, update.course, settings.friction, proxy);
    if (rest == Rest::at_target) proxy.sliding = false;
    return finish_update(proxy, update, hip, rest);
}

}  // namespace palpate
