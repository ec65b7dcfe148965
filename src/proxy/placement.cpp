// Placing a proxy away from the servo thread, and straight rays that meet the surface.
#include <optional>

#include "proxy/update.hpp"

namespace palpate {

namespace {

Vec3 normal_of(const Field& field, const LatticePoint& point) {
    const Vec3 out = -field.sign() * gradient_at(field, point).cwiseProduct(field.voxels_per_mm());
    const double length = out.norm();
    if (!(length > 0)) return Vec3::Zero();
    return physical_from_grid_axes(field.geometry(), out / length);
}

struct FirstHit {
    LatticePoint at;
    bool at_start;  ///< inside the solid from the start
};

/// The place where straight motion from one point (index space) to another meets the surface.
template <class AnySite>
std::optional<FirstHit> first_hit(const Field& field, double isovalue, const Vec3& start,
                                  const Vec3& target, int step_budget) {
    AnySite site(field, isovalue - field.offset(), field.sign(), AnySite::located(start));
    Progress progress{field.geometry(), {}, target, step_budget};
    const bool at_start = site.excess() > site.level();
    if (!at_start && walk_to(site, target, progress) != WalkEnd::surface) return std::nullopt;
    return FirstHit{site.point, at_start};
}

/// A straight way in index space.
struct Segment {
    Vec3 from, to;
};

/// The segment itself, or where it has an end that is too far for the lattice, its part in and
/// around the grid: the rest lies in the background. Nothing if there is no such part.
std::optional<Segment> near_grid(const Geometry& geometry, const Segment& whole) {
    const auto reaches = [](const Vec3& end) {
        return end.cwiseAbs().maxCoeff() <= farthest_index;
    };
    if (reaches(whole.from) && reaches(whole.to)) return whole;
    constexpr double margin = 4;  // [voxels] beyond which no sample counts
    const Vec3 way = whole.to - whole.from;
    if (!way.allFinite()) return std::nullopt;
    const Stay near = stay_in_box(whole.from, way, 1, -margin, geometry.size, margin);
    if (near.enter > near.leave) return std::nullopt;
    return Segment{whole.from + near.enter * way, whole.from + near.leave * way};
}

}  // namespace

Vec3 normal_at(const Proxy& proxy, const Field& field) {
    const Vec3 normal = normal_of(field, scp_in(field, proxy));
    return proxy.behind && proxy.turned ? Vec3(-normal) : normal;
}

void field_will_change(Proxy& proxy, const Field& field) {
    // If there are several changes before the next update, the first one had the touched surface.
    if (proxy.mode == Mode::constrained && proxy.normal_before.isZero(0)) {
        proxy.normal_before = normal_at(proxy, field);
    }
}

bool place(Proxy& proxy, const Field& field, const Vec3& hip, double isovalue,
           StepObserver observer) {
    proxy = Proxy{};
    proxy.isovalue = isovalue;
    const int patience = 1000 + static_cast<int>(field.geometry().size.cast<double>().norm());
    for (int i = 0; i < patience; ++i) {
        // If the hand is in the solid, recovery leads to the surface and no farther.
        const ProxyUpdate update = update_straight(proxy, field, hip, {}, observer);
        if (update.status != UpdateStatus::recovering) return proxy.placed;
    }
    return false;
}

RayHit cast_ray(const Field& field, double isovalue, const Vec3& from, const Vec3& to,
                int step_budget) {
    const Geometry& geometry = field.geometry();
    const Vec3 start = index_from_physical(geometry, from);
    const Vec3 target = index_from_physical(geometry, to);
    RayHit ray{false, to, Vec3::Zero()};
    if (!start.allFinite() || !target.allFinite()) return ray;
    const std::optional<Segment> near = near_grid(geometry, {start, target});
    const bool is_in_background = !near || near->from != start;
    if (is_in_background && field.sign() * (field.background() - isovalue) > 0) {
        return {true, from, Vec3::Zero()};
    }
    if (!near) return ray;
    const auto hit_of =
        field.interpolation() == Interpolation::cubic ? first_hit<CubicSite> : first_hit<Site>;
    const std::optional<FirstHit> met = hit_of(field, isovalue, near->from, near->to, step_budget);
    if (!met) return ray;
    ray.hit = true;
    const bool from_inside = met->at_start && !is_in_background;  // without rounding
    ray.point = from_inside
                    ? from
                    : physical_from_index(geometry, index_of(field.interpolation(), met->at));
    ray.normal = normal_of(field, met->at);
    return ray;
}

}  // namespace palpate
