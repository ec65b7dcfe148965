// Begin and end of an update, shared by the methods.
#include "proxy/update.hpp"

#include <algorithm>
#include <cmath>

#include "proxy/cone.hpp"

namespace palpate {
namespace {

Vec3 normal_of(const Site& site) {
    const Tetrahedron& t = site.point.tetrahedron;
    const Geometry& geometry = site.field.geometry();
    const Vec3 out = -unfold(t, site.excess.gradient).cwiseQuotient(geometry.spacing);
    const double length = std::sqrt(dot(out, out));
    if (!(length > 0)) return Vec3::Zero();
    return physical_from_grid_axes(geometry, out / length);
}

/// Where the HIP is free and the way out was longer than the way to it, the HIP is the better place
/// (algorithm note, recovery). Lengths in mm.
void prefer_free_hip(Site& site, Course& course, const Vec3& start_index) {
    const Vec3& spacing = course.geometry.spacing;
    const Vec3 way_out = (index_of(site.point) - start_index).cwiseProduct(spacing);
    const Vec3 way_to_hip = (course.target - start_index).cwiseProduct(spacing);
    if (!(dot(way_out, way_out) > dot(way_to_hip, way_to_hip))) return;
    const Site at_hip(site.field, site.isovalue, site.sign, locate(course.target));
    if (at_hip.excess_here() > 0) return;
    site.move_to(at_hip.point);
    course.report(StepKind::recover, site);
}

}  // namespace

double surface_tolerance(const Field& field) {
    // Samples far from zero (a float volume of 1e6 +- 1) cost digits in every sum of eight.
    const double largest =
        std::max(std::abs(field.volume().minimum()), std::abs(field.volume().maximum()));
    return std::max(1e-12 * field.range(), 8 * std::numeric_limits<double>::epsilon() * largest);
}

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

Begin begin_update(Proxy& proxy, const Field& field, const Vec3& hip, const ProxySettings& settings,
                   StepObserver observer) {
    const Vec3 target = index_from_physical(field.geometry(), hip);
    if (!(target.cwiseAbs().maxCoeff() <= farthest_index) || std::isnan(proxy.isovalue)) return {};
    const bool first = !proxy.placed;
    if (first) {
        proxy = Proxy{
            .scp = locate(target), .scp_physical = hip, .isovalue = proxy.isovalue, .placed = true};
    }
    Begin begin{Update{Site(field, proxy.isovalue, field.sign(), proxy.scp),
                       Course{field.geometry(), observer, target, settings.step_budget}}};
    Site& site = begin.update->site;
    Course& course = begin.update->course;
    if (first) course.report(StepKind::place, site);
    if (!(site.excess_here() > surface_tolerance(field))) {
        proxy.recovery_reach = 0;
        return begin;
    }
    const Vec3 start = index_of(site.point);
    begin.recovering = !recover(site, course, proxy.recovery_reach);
    if (!begin.recovering) prefer_free_hip(site, course, start);
    return begin;
}

ProxyUpdate finish_update(Proxy& proxy, const Update& update, const Vec3& hip, Rest rest) {
    const Site& site = update.site;
    proxy.scp = site.point;
    proxy.scp_physical = rest == Rest::at_target
                             ? hip
                             : physical_from_index(update.course.geometry, index_of(site.point));
    proxy.mode = rest == Rest::on_surface || rest == Rest::recovering ||
                         (rest == Rest::out_of_budget &&
                          site.excess_here() >= -surface_tolerance(site.field))
                     ? Mode::constrained
                     : Mode::free;
    ProxyUpdate result;
    result.status = rest == Rest::recovering      ? UpdateStatus::recovering
                    : rest == Rest::out_of_budget ? UpdateStatus::out_of_budget
                                                  : UpdateStatus::done;
    result.mode = proxy.mode;
    result.hip = hip;
    result.scp = proxy.scp_physical;
    result.normal = normal_of(site);
    result.density = piece_of(site.point.tetrahedron, site.samples)(site.point.folded);
    result.isovalue = proxy.isovalue;
    result.tetrahedra = update.course.tetrahedra;
    return result;
}

}  // namespace palpate
