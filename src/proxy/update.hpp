// What every proxy method does before and after its own part: refuse bad input, place the proxy,
// recover, describe the result. `AnySite` is Site on the linear field and CubicSite on the smooth
// one.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "proxy/cubic_site.hpp"

namespace palpate {

/// False for a coefficient that is NaN or below 0.
inline bool is_possible(const Friction& friction) {
    return friction.static_coefficient >= 0 && friction.dynamic_coefficient >= 0;
}
/// False for a HIP (index space) that is not finite or too far from the grid (farthest_hip), for
/// an isovalue that is NaN or at which all of space is solid, and for friction that is not
/// possible. For a point and a tool.
inline bool accepts(double isovalue, const Field& field, const Vec3& hip_index,
                    const Friction& friction) {
    const auto near = [&](int a) {
        // Mostly the first comparison is enough: the grid begins at 0.
        return std::abs(hip_index[a]) <= farthest_hip ||
               (hip_index[a] > 0 && hip_index[a] <= field.geometry().size[a] + farthest_hip);
    };
    return near(0) && near(1) && near(2) &&
           field.sign() * isovalue > -std::numeric_limits<double>::infinity() &&
           is_possible(friction);
}
/// The result of an update that changed nothing.
ProxyUpdate refuse_update(const Proxy& proxy, const Field& field, const Vec3& hip,
                          UpdateStatus why = UpdateStatus::refused);
/// The SCP in the lattice of a field, also after an update on one of another interpolation.
inline LatticePoint scp_in(const Field& field, const Proxy& proxy) {
    if (proxy.interpolation == field.interpolation()) return proxy.scp;
    return locate(field.interpolation(), index_from_physical(field.geometry(), proxy.scp_physical));
}
/// The SCP stays in physical space, on the lattice of another field from now on.
inline void put_on_lattice(Proxy& proxy, const Field& field) {
    proxy.interpolation = field.interpolation();
    proxy.scp =
        locate(field.interpolation(), index_from_physical(field.geometry(), proxy.scp_physical));
}
/// False if the SCP is NaN or infinite.
bool is_finite(const Proxy& proxy);

/// The state of a running update. The constructor places the proxy if necessary and brings it out
/// of the solid, unless `recovering` says that it is still inside.
template <class AnySite>
struct Update {
    Update(Proxy& proxy, const Field& field, const Vec3& hip_index, const ProxySettings& settings,
           StepObserver observer);

    AnySite site;
    Progress progress;
    const int budget;
    double searched = 0;  ///< [mm], see ProxyUpdate
    bool recovering = false;
};

inline bool has_friction(const Friction& friction) {
    return friction.static_coefficient > 0 || friction.dynamic_coefficient > 0;
}

/// Coulomb's law for both fields: which share of the pull aside friction holds back, so that the
/// SCP ends up trailing the hand at the friction angle. Nothing: the SCP sticks.
inline std::optional<double> held_share(const Friction& friction, Proxy& proxy, double aside,
                                        double pressing) {
    const double mu = proxy.sliding ? friction.dynamic_coefficient : friction.static_coefficient;
    proxy.sliding = aside > mu * pressing;
    if (!proxy.sliding) return std::nullopt;
    const double share = friction.dynamic_coefficient * pressing / aside;
    return share < 1 ? share : 1;
}

/// A site at another point (index space) that takes the solid of this one for free.
template <class AnySite>
AnySite turned_at(const AnySite& site, const Vec3& index) {
    return {site.field, site.isovalue, -site.sign, AnySite::located(index)};
}

/// How a method's own part ended.
enum class Rest { at_target, on_surface, out_of_budget, recovering };

/// Writes the site back into the proxy and describes the result.
template <class AnySite>
ProxyUpdate finish_update(Proxy& proxy, Update<AnySite>& update, const Vec3& hip, Rest rest);

/// An update: bad input is refused, the proxy placed and brought out of the solid, and then
/// own(site, progress) is the method's own part and returns how it ended.
template <class AnySite, class Own>
[[gnu::always_inline]] inline ProxyUpdate update_by(Proxy& proxy, const Field& field,
                                                    const Vec3& hip, const ProxySettings& settings,
                                                    StepObserver observer, Own&& own) {
    const Vec3 target = index_from_physical(field.geometry(), hip);
    if (!accepts(proxy.isovalue, field, target, settings.friction) ||
        !is_possible(settings.behind)) {
        return refuse_update(proxy, field, hip);
    }
    Update<AnySite> update(proxy, field, target, settings, observer);
    const Rest rest = update.recovering ? Rest::recovering : own(update.site, update.progress);
    return finish_update(proxy, update, hip, rest);
}

/// Brings the site out of the solid: steepest descent of the excess field from tetrahedron to
/// tetrahedron until it is zero; where that gets stuck, to the nearest free point along 26
/// directions. True when out. `reach` [voxel] is how far the directions were searched so far; it is
/// kept between updates.
template <class AnySite>
bool recover(AnySite& site, Progress& progress, double& reach);

/// Exact descent on the smooth field.
ProxyUpdate update_cubic(Proxy& proxy, const Field& field, const Vec3& hip,
                         const ProxySettings& settings, StepObserver observer);

}  // namespace palpate
