// Method paper: Fig. 4 of Corenthy et al. 2012 as published, the baseline that exact descent is
// compared with. Its goal must satisfy the planes of all tetrahedra at the SCP at once (after
// Ruspini et al. 1997): the intersection of their free sides, where the free space is the union.
#include <cmath>

#include "palpate/baselines/methods.hpp"
#include "proxy/cone.hpp"
#include "proxy/update.hpp"

namespace palpate::baselines {
namespace {

/// The constraint planes of every tetrahedron that contains the SCP, normals in mm, index axes.
HalfSpaces<48> constraint_planes(const Site& site, const Incident& incident, const Vec3& spacing) {
    HalfSpaces<48> planes;
    for (int i = 0; i < incident.count; ++i) {
        const Tetrahedron& t = incident.tetrahedra[i];
        const Vec3 normal = unfold(t, site.excess_gradient_in(t)).cwiseQuotient(spacing);
        bool known = dot(normal, normal) == 0;
        for (int j = 0; j < planes.count; ++j) known |= planes.normal[j] == normal;
        if (!known) planes.add(normal);
    }
    return planes;
}

/// The incident tetrahedron that `direction` (index axes) points into.
const Tetrahedron& tetrahedron_towards(const Incident& incident, unsigned on,
                                       const Vec3& direction) {
    for (int i = 0; i < incident.count; ++i) {
        const Vec3 folded = fold(incident.tetrahedra[i], direction);
        bool inside = true;
        for (unsigned w = 0; w < wall_count; ++w) {
            if (has(on, w)) inside &= approach(folded, w) <= 0;
        }
        if (inside) return incident.tetrahedra[i];
    }
    return incident.tetrahedra[0];  // not reached: the incident tetrahedra fill all directions
}

/// One step of the constrained mode: goal, then at most one tetrahedron towards it. False at the
/// goal.
bool step_constrained(Site& site, Progress& progress) {
    const Vec3& spacing = progress.geometry.spacing;
    const Incident incident = incident_tetrahedra(site.point);
    const HalfSpaces<48> planes = constraint_planes(site, incident, spacing);
    // Each pair of planes is tried, and compared with all.
    progress.charge(incident.count + planes.count * planes.count * planes.count / 200);
    const Vec3 h_mm = progress.to_target(site).cwiseProduct(spacing);
    const Vec3 to_goal_mm = project_on_cone(h_mm, planes).point;
    const Vec3 to_goal = to_goal_mm.cwiseQuotient(spacing);
    const Vec3 goal = index_of(site.point) + to_goal;
    progress.report(StepKind::goal, site, goal);
    if (dot(to_goal_mm, to_goal_mm) <= 1e-18 * dot(spacing, spacing)) return false;
    const unsigned on = walls_at(site.point.folded);
    const Tetrahedron& towards = tetrahedron_towards(incident, on, to_goal);
    const Vec3 folded = fold(towards, to_goal);
    unsigned kept = 0;  // walls the motion runs along
    for (unsigned w = 0; w < wall_count; ++w) {
        if (has(on, w) && approach(folded, w) == 0) kept |= 1U << w;
    }
    site.enter(towards);
    slide(site, folded, on, kept, progress);
    progress.report(StepKind::slide, site, goal);
    return true;
}

}  // namespace

ProxyUpdate update_paper(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings, StepObserver observer) {
    if (field.interpolation() != Interpolation::linear) return refuse_update(proxy, field, hip);
    const auto descend = [&](Site& site, Progress& progress) {
        const double tolerance = field.tolerance();
        bool constrained = proxy.mode == Mode::constrained && site.excess() >= -tolerance;
        while (progress.budget > 0) {
            if (!constrained) {
                // The walk crosses into the right tetrahedron by itself.
                const WalkEnd end = walk(site, progress.folded_to_target(site), progress);
                progress.report(StepKind::free_move, site);
                if (end == WalkEnd::target) return Rest::at_target;
                constrained = true;
                continue;
            }
            if (!step_constrained(site, progress)) return Rest::on_surface;
            if (site.excess() < -tolerance) constrained = false;
        }
        return Rest::out_of_budget;
    };
    return update_by<Site>(proxy, field, hip, settings, observer, descend);
}

}  // namespace palpate::baselines
