// Start and end of an update, shared by all methods.
#include "proxy/update.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proxy/cone.hpp"

namespace palpate {
namespace {

double squared(const Vec3& v) {
    return dot(v, v);
}

double sum_of(const Vec3& v) {
    return v[0] + v[1] + v[2];
}

/// False for a sum of which a term is NaN or infinite.
bool is_finite(double sum) {
    return sum - sum == 0;
}

/// If the HIP is free and nearer to the start than the point that recovery found, the proxy goes to
/// the HIP. Distances in mm.
template <class AnySite>
void prefer_free_hip(AnySite& site, Progress& progress, const Vec3& start_index) {
    const Vec3& spacing = progress.geometry.spacing;
    const Vec3 out = (site.index() - start_index).cwiseProduct(spacing);
    const Vec3 to_hip = (progress.target - start_index).cwiseProduct(spacing);
    if (!(dot(out, out) > dot(to_hip, to_hip))) return;
    AnySite at_hip(site.field, site.isovalue, site.sign, AnySite::located(progress.target));
    const double excess = at_hip.excess();
    if (excess > site.level() || excess < -site.thickness) return;
    site.move_to(at_hip.point);
    progress.report(StepKind::recover, site);
}

/// A surface is taken to have moved by at most this much [voxel] when the field changed.
constexpr double farthest_push = 8;

/// A wall that moved over the proxy pushes it `ahead`, to the side on which it was, even where the
/// other side is nearer. True if the point that recovery found, or the one found here, lies ahead.
template <class AnySite>
bool push_ahead(AnySite& site, Progress& progress, const Vec3& start_index, const Vec3& ahead) {
    const Vec3& spacing = progress.geometry.spacing;
    const Vec3 normal = grid_axes_from_physical(progress.geometry, ahead);
    const Vec3 out = (site.index() - start_index).cwiseProduct(spacing);
    const double farthest = farthest_push * spacing.maxCoeff();
    if (dot(out, normal) >= 0) return dot(out, out) <= farthest * farthest;
    AnySite probe = turned_at(site, start_index);
    Progress silent{progress.geometry, {}, start_index, progress.budget};
    const Vec3 push = (farthest * normal).cwiseQuotient(spacing);
    const WalkEnd end = walk_out(probe, push, silent);
    progress.budget = silent.budget;
    if (end != WalkEnd::surface) return false;
    site.move_to(probe.point);
    progress.report(StepKind::recover, site);
    return true;
}

}  // namespace

ProxyUpdate refuse_update(const Proxy& proxy, const Field& field, const Vec3& hip,
                          UpdateStatus why) {
    ProxyUpdate result;
    result.status = why;
    result.mode = proxy.mode;
    result.hip = hip;
    result.scp = proxy.scp_physical;
    result.behind = proxy.mode == Mode::constrained && proxy.behind && proxy.turned;
    result.isovalue = result.behind ? *proxy.behind : proxy.isovalue;
    if (proxy.placed) result.density = value_at(field, scp_in(field, proxy));
    return result;
}

bool is_finite(const Proxy& proxy) {
    const Vec3& physical = proxy.scp_physical;
    return is_finite(sum_of(proxy.scp.folded) + physical[0] + physical[1] + physical[2]);
}

template <class AnySite>
Update<AnySite>::Update(Proxy& proxy, const Field& field, const Vec3& hip_index,
                        const ProxySettings& settings, StepObserver observer)
    : site(AnySite::of(proxy, field,
                       proxy.placed ? scp_in(field, proxy) : AnySite::located(hip_index))),
      progress{field.geometry(), observer, hip_index, settings.step_budget},
      budget(settings.step_budget) {
    if (!proxy.placed) progress.report(StepKind::place, site);
    if (site.is_beyond_behind()) site.turn();
    if (!site.is_inside()) {
        proxy.recovery_reach = 0;
        return;
    }
    const Vec3 start = site.index();
    const Vec3& spacing = progress.geometry.spacing;
    const auto from_start = [&] {
        return std::sqrt(squared((site.index() - start).cwiseProduct(spacing)));
    };
    recovering = !recover(site, progress, proxy.recovery_reach) || site.is_beyond_behind();
    searched = std::max(from_start(), proxy.recovery_reach * spacing.minCoeff());
    if (recovering) return;
    const bool pushed =
        !proxy.normal_before.isZero(0) && push_ahead(site, progress, start, proxy.normal_before);
    searched = std::max(searched, from_start());
    if (!pushed) prefer_free_hip(site, progress, start);
}

template <class AnySite>
ProxyUpdate finish_update(Proxy& proxy, Update<AnySite>& update, const Vec3& hip, Rest rest) {
    AnySite& site = update.site;
    if (!is_finite(sum_of(site.point.folded))) {
        return refuse_update(proxy, site.field, hip, UpdateStatus::not_finite);
    }
    proxy.placed = true;
    proxy.scp = site.point;
    proxy.interpolation = site.field.interpolation();
    proxy.turned = site.turned;
    if (rest != Rest::recovering) proxy.normal_before.setZero();
    proxy.scp_physical =
        rest == Rest::at_target ? hip : physical_from_index(update.progress.geometry, site.index());
    proxy.mode = rest == Rest::on_surface || rest == Rest::recovering ||
                         (rest == Rest::out_of_budget && site.in_contact())
                     ? Mode::constrained
                     : Mode::free;
    const bool behind = site.turned && proxy.mode == Mode::constrained;
    const double density = site.density();
    site.keep(proxy);
    return {.status = rest == Rest::recovering      ? UpdateStatus::recovering
                      : rest == Rest::out_of_budget ? UpdateStatus::out_of_budget
                                                    : UpdateStatus::done,
            .mode = proxy.mode,
            .hip = hip,
            .scp = proxy.scp_physical,
            .density = density,
            .isovalue = behind ? *proxy.behind : proxy.isovalue,
            .behind = behind,
            .tetrahedra = update.progress.tetrahedra,
            .work = update.budget - std::max(0, update.progress.budget),
            .searched = update.searched};
}

template struct Update<Site>;
template struct Update<CubicSite>;
template ProxyUpdate finish_update(Proxy&, Update<Site>&, const Vec3&, Rest);
template ProxyUpdate finish_update(Proxy&, Update<CubicSite>&, const Vec3&, Rest);

}  // namespace palpate
