// Placing a proxy away from the servo thread, and straight rays that meet the surface.
#include "proxy/update.hpp"

namespace palpate {

namespace {

Vec3 normal_of(const Field& field, const Tetrahedron& t) {
    const Vec3 gradient = unfold(t, piece_of(t, field.cell(t.cell)).gradient);
    const Vec3 out = -field.sign() * gradient.cwiseProduct(field.voxels_per_mm());
    const double length = out.norm();
    if (!(length > 0)) return Vec3::Zero();
    return physical_from_grid_axes(field.geometry(), out / length);
}

}  // namespace

Vec3 normal_at(const Proxy& proxy, const Field& field) {
    return normal_of(field, proxy.scp.tetrahedron);
}

void field_will_change(Proxy& proxy, const Field& field) {
    // Of several changes before the next update, the first one had the surface that was felt.
    if (proxy.mode == Mode::constrained && proxy.ahead.isZero(0)) {
        proxy.ahead = normal_at(proxy, field);
    }
}

bool place(Proxy& proxy, const Field& field, const Vec3& hip, double isovalue,
           StepObserver observer) {
    proxy = Proxy{};
    proxy.isovalue = isovalue;
    const Vec3 size = field.geometry().size.cast<double>();
    const int patience = 1000 + static_cast<int>(size.norm());
    const Vec3 target = index_from_physical(field.geometry(), hip);
    if (!accepts(proxy, field, target)) return false;
    const LatticePoint start = locate(target);
    for (int i = 0; i < patience; ++i) {
        const Update<Site> update(proxy, field, target, {}, observer);
        // Not by coordinates: those of a point just below zero do not come back bit for bit.
        const LatticePoint& at = update.site.point;
        const bool stayed =
            same_tetrahedron(at.tetrahedron, start.tetrahedron) && at.folded == start.folded;
        finish_update(proxy, update, hip,
                      update.recovering ? Rest::recovering
                      : stayed          ? Rest::at_target
                                        : Rest::on_surface);
        if (!update.recovering) return proxy.placed;
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
    Site site(field, isovalue - field.offset(), field.sign(), locate(start));
    Progress progress{geometry, {}, target, step_budget};
    ray.hit = site.excess() > 0 ||
              walk(site, progress.folded_to_target(site), progress) == WalkEnd::surface;
    if (!ray.hit) return ray;
    ray.point = physical_from_index(geometry, index_of(site.point));
    ray.normal = normal_of(field, site.point.tetrahedron);
    return ray;
}

}  // namespace palpate
