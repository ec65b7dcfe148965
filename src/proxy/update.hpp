// What every proxy method does before and after its own part: refuse bad input, place, recover,
// and say how it ended.
#pragma once

#include "proxy/site.hpp"

namespace palpate {

/// False for a HIP (index space) that is not finite or absurdly far.
bool accepts(const Proxy& proxy, const Vec3& hip_index);
/// The result for such a HIP: nothing changed.
ProxyUpdate refuse_update(const Proxy& proxy, const Field& field, const Vec3& hip);

/// An update under way: where the proxy is and what it may spend. It begins with a proxy that is
/// placed, and out of the solid unless `recovering`.
struct Update {
    Update(Proxy& proxy, const Field& field, const Vec3& hip_index, const ProxySettings& settings,
           StepObserver observer);

    Site site;
    Course course;
    bool recovering = false;
};

/// How a method's own part ended.
enum class Rest { at_target, on_surface, out_of_budget, recovering };

/// Writes the site back into the proxy and describes the result.
ProxyUpdate finish_update(Proxy& proxy, const Update& update, const Vec3& hip, Rest rest);

/// Brings the site out of the solid: steepest descent of the excess field from tetrahedron to
/// tetrahedron until it is zero; where that gets stuck, the nearest way out along 26 directions.
/// True when out. `reach` is how far the search along the directions came (kept between updates).
bool recover(Site& site, Course& course, double& reach);

}  // namespace palpate
