// Method exact: descent over the union of the incident tetrahedra's free cones (docs/proxy.md).
#include <cmath>
#include <optional>

#include "proxy/move.hpp"
#include "proxy/update.hpp"

namespace palpate {
namespace {

/// Gains below this are rounding [mm^2 per mm^2 of the smallest voxel].
constexpr double least_gain = 1e-18;

/// Moves the target back against the direction in which the SCP would slide, so that the SCP ends
/// up trailing the hand at the friction angle. False if the SCP sticks. The move is h projected on
/// the free cone: its length is the tangential pull and the rest of h the normal pull, on ridges
/// and corners too.
bool apply_friction(const Friction& friction, Proxy& proxy, const Site& site, const Move& move,
                    Progress& progress) {
    const Vec3 h = progress.to_target(site).cwiseProduct(progress.geometry.spacing);
    const Vec3 s = fold_lengths(move.tetrahedron, progress.geometry.spacing);
    const Vec3 tangential = unfold(move.tetrahedron, move.step.cwiseProduct(s));
    const Vec3 normal = h - tangential;
    const auto share = held_share(friction, proxy, std::sqrt(dot(tangential, tangential)),
                                  std::sqrt(dot(normal, normal)));
    if (!share) return false;
    progress.target -= (tangential * *share).cwiseQuotient(progress.geometry.spacing);
    return true;
}

/// Rounding can leave an SCP beside the vertex or edge that it slid to, where it does not see all
/// tetrahedra of that corner and rests behind a bump as low as rounding. So before it rests it
/// looks from the corner of the walls nearer than this [voxel]; f changes by at most 4 ranges a
/// voxel, so moving to the corner keeps G1 and G2.
constexpr double hair = 1e-10;
/// The least gain from there: much more than moving there can cost, so that it cannot cycle.
constexpr double least_corner_gain = 1e-12;

/// Puts the SCP, which is on the walls `on`, on all walls within a hair of it, if from there it can
/// move closer to the target.
std::optional<Move> move_from_corner(Site& site, unsigned on, Progress& progress, double enough) {
    unsigned near = 0;
    for (unsigned w = 0; w < wall_count; ++w) {
        near |= unsigned(slack(site.point.folded, w) <= hair) << w;
    }
    if (near == on) return std::nullopt;
    Site corner = site;
    corner.point.folded = snap(site.point.folded, near);
    const Move move =
        best_move(corner, walls_at(corner.point.folded), true, progress.folded_to_target(corner));
    progress.charge(move.work);
    if (!(move.gain > enough)) return std::nullopt;
    site.point = corner.point;
    return move;
}

Rest descend(Site& site, Progress& progress, const ProxySettings& settings, Proxy& proxy) {
    const Vec3& spacing = progress.geometry.spacing;
    const double shortest = spacing.minCoeff();
    const double enough = least_gain * shortest * shortest;
    const double enough_at_corner = least_corner_gain * shortest * shortest;
    std::optional<Move> from_corner;
    const Vec3 hip = progress.target;
    const auto friction = [&]() -> const Friction& {
        return site.turned ? settings.behind : settings.friction;
    };
    bool friction_pending = has_friction(settings.friction) || has_friction(settings.behind);
    while (progress.budget > 0) {
        const unsigned on = walls_at(site.point.folded);
        const bool contact = site.excess() >= -site.field.tolerance();
        const Move move = from_corner
                              ? *from_corner
                              : best_move(site, on, contact, progress.folded_to_target(site));
        if (!from_corner) progress.charge(move.work);
        from_corner.reset();
        if (move.straight) {
            if (on != 0) site.enter(move.tetrahedron);
            const WalkEnd end = walk(site, move.step, progress);
            progress.report(StepKind::free_move, site);
            if (end != WalkEnd::target) continue;
            if (progress.target == hip) {
                proxy.sliding = false;
                return Rest::at_target;
            }
            // Friction moved the target back to a point in free space, where there is no friction.
            progress.target = hip;
            friction_pending = true;
            continue;
        }
        if (friction_pending) {
            friction_pending = false;
            if (!apply_friction(friction(), proxy, site, move, progress)) return Rest::on_surface;
            continue;
        }
        if (move.gain <= enough) {
            from_corner = move_from_corner(site, on, progress, enough_at_corner);
            if (!from_corner) return Rest::on_surface;
            continue;
        }
        if (on != 0) site.enter(move.tetrahedron);
        const bool at_minimum = slide(site, move.step, on, move.walls, progress);
        progress.report(StepKind::slide, site);
        // Inside a tetrahedron the minimum of its cone is the minimum: no other one is incident.
        if (at_minimum && walls_at(site.point.folded) == 0) {
            from_corner = move_from_corner(site, 0, progress, enough_at_corner);
            if (!from_corner) return Rest::on_surface;
        }
    }
    return Rest::out_of_budget;
}

}  // namespace

ProxyUpdate update_exact(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings, StepObserver observer) {
    if (field.interpolation() == Interpolation::cubic) {
        return update_cubic(proxy, field, hip, settings, observer);
    }
    return update_by<Site>(
        proxy, field, hip, settings, observer,
        [&](Site& site, Progress& progress) { return descend(site, progress, settings, proxy); });
}

}  // namespace palpate
