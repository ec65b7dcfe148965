// Placing a proxy away from the servo thread, and straight rays that meet the surface.
#include "proxy/update.hpp"

namespace palpate {

bool place(Proxy& proxy, const Field& field, const Vec3& hip, double isovalue,
           StepObserver observer) {
    proxy = Proxy{};
    proxy.isovalue = isovalue;
    const Vec3 size = field.geometry().size.cast<double>();
    const int patience = 1000 + static_cast<int>(size.norm());
    for (int i = 0; i < patience; ++i) {
        const Begin begin = begin_update(proxy, field, hip, {}, observer);
        if (!begin.update) return false;
        const bool out = !begin.recovering;
        const bool moved = out && index_of(begin.update->site.point) != begin.update->course.target;
        finish_update(proxy, *begin.update, hip,
                      !out    ? Rest::recovering
                      : moved ? Rest::on_surface
                              : Rest::at_target);
        if (out) return true;
    }
    return false;
}

RayHit cast_ray(const Field& field, double isovalue, const Vec3& from, const Vec3& to,
                int step_budget) {
    const Geometry& geometry = field.geometry();
    const Vec3 start = index_from_physical(geometry, from);
    const Vec3 target = index_from_physical(geometry, to);
    RayHit ray{false, to, Vec3::Zero()};
    if (!(start.cwiseAbs().maxCoeff() <= farthest_index) ||
        !(target.cwiseAbs().maxCoeff() <= farthest_index)) {
        return ray;
    }
    Proxy proxy{.scp = locate(start), .scp_physical = from, .isovalue = isovalue, .placed = true};
    Update update{Site(field, isovalue, field.sign(), proxy.scp),
                  Course{geometry, {}, target, step_budget}};
    Site& site = update.site;
    ray.hit = site.excess_here() > 0 ||
              walk(site, update.course.to_target(site), update.course) == WalkEnd::surface;
    if (!ray.hit) return ray;
    const ProxyUpdate at = finish_update(proxy, update, from, Rest::on_surface);
    ray.point = at.scp;
    ray.normal = at.normal;
    return ray;
}

}  // namespace palpate
