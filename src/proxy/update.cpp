// Begin and end of an update, shared by the methods.
#include "proxy/update.hpp"

#include <algorithm>
#include <cmath>

#include "proxy/cone.hpp"

namespace palpate {
namespace {

/// Where the HIP is free and the way out was longer than the way to it, the HIP is the better place
/// (algorithm note, recovery). Lengths in mm.
void prefer_free_hip(Site& site, Course& course, const Vec3& start_index) {
    const Vec3& spacing = course.geometry.spacing;
    const Vec3 way_out = (index_of(site.point) - start_index).cwiseProduct(spacing);
    const Vec3 way_to_hip = (course.target - start_index).cwiseProduct(spacing);
    if (!(dot(way_out, way_out) > dot(way_to_hip, way_to_hip))) return;
    const Site at_hip(site.field, site.isovalue, site.sign, locate(course.target));
    if (at_hip.excess() > 0) return;
    site.move_to(at_hip.point);
    course.report(StepKind::recover, site);
}

/// Farther than this [voxel] a change of the field is not taken for a surface that moved.
constexpr double farthest_push = 8;

/// A wall that came over the proxy pushes it ahead, to the side on which it was, though the other
/// side may be nearer. True if the way out lies, or was found, ahead.
bool push_ahead(Site& site, Course& course, const Vec3& start_index, const Vec3& ahead) {
    const Vec3& spacing = course.geometry.spacing;
    const Vec3 out = grid_axes_from_physical(course.geometry, ahead);
    const Vec3 way = (index_of(site.point) - start_index).cwiseProduct(spacing);
    const double farthest = farthest_push * spacing.maxCoeff();
    if (dot(way, out) >= 0) return dot(way, way) <= farthest * farthest;
    // The solid is the free side of the field with its sign turned.
    Site probe(site.field, site.isovalue, -site.sign, locate(start_index));
    Course silent{course.geometry, {}, start_index, course.budget};
    const Vec3 push = (farthest * out).cwiseQuotient(spacing);
    const WalkEnd end = walk(probe, fold(probe.point.tetrahedron, push), silent);
    course.budget = silent.budget;
    if (end != WalkEnd::surface) return false;
    site.move_to(probe.point);
    course.report(StepKind::recover, site);
    return true;
}

}  // namespace

ProxyUpdate refuse_update(const Proxy& proxy, const Field& field, const Vec3& hip) {
    ProxyUpdate result;
    result.status = UpdateStatus::refused;
    result.mode = proxy.mode;
    result.hip = hip;
    result.scp = proxy.scp_physical;
    result.isovalue = proxy.isovalue;
    if (proxy.placed) result.density = value_at(field, proxy.scp);
    return result;
}

bool accepts(const Proxy& proxy, const Vec3& hip_index) {
    return hip_index.cwiseAbs().maxCoeff() <= farthest_index && !std::isnan(proxy.isovalue);
}

namespace {

/// Where the update starts; the first one of a proxy places it at its HIP.
const LatticePoint& start_of(Proxy& proxy, const Vec3& hip_index) {
    if (!proxy.placed) proxy.scp = locate(hip_index);
    return proxy.scp;
}

}  // namespace

Update::Update(Proxy& proxy, const Field& field, const Vec3& hip_index,
               const ProxySettings& settings, StepObserver observer)
    : site(field, proxy.isovalue, field.sign(), start_of(proxy, hip_index)),
      course{field.geometry(), observer, hip_index, settings.step_budget} {
    if (!proxy.placed) course.report(StepKind::place, site);
    proxy.placed = true;
    if (!(site.excess() > field.tolerance())) {
        proxy.recovery_reach = 0;
        return;
    }
    const Vec3 start = index_of(site.point);
    recovering = !recover(site, course, proxy.recovery_reach);
    if (recovering) return;
    if (!proxy.ahead.isZero(0) && push_ahead(site, course, start, proxy.ahead)) return;
    prefer_free_hip(site, course, start);
}

ProxyUpdate finish_update(Proxy& proxy, const Update& update, const Vec3& hip, Rest rest) {
    const Site& site = update.site;
    proxy.scp = site.point;
    if (rest != Rest::recovering) proxy.ahead.setZero();
    proxy.scp_physical = rest == Rest::at_target
                             ? hip
                             : physical_from_index(update.course.geometry, index_of(site.point));
    proxy.mode = rest == Rest::on_surface || rest == Rest::recovering ||
                         (rest == Rest::out_of_budget && site.excess() >= -site.field.tolerance())
                     ? Mode::constrained
                     : Mode::free;
    return {.status = rest == Rest::recovering      ? UpdateStatus::recovering
                      : rest == Rest::out_of_budget ? UpdateStatus::out_of_budget
                                                    : UpdateStatus::done,
            .mode = proxy.mode,
            .hip = hip,
            .scp = proxy.scp_physical,
            .density = site.density(),
            .isovalue = proxy.isovalue,
            .tetrahedra = update.course.tetrahedra};
}

}  // namespace palpate
