// What every proxy method does before and after its own part: refuse bad input, place, recover,
// and say how it ended.
#pragma once

#include <optional>

#include "proxy/site.hpp"

namespace palpate {

/// An update under way: where the proxy is and what it may spend.
struct Update {
    Site site;
    Course course;
};

/// Begins an update: nothing (with `refusal` filled) if the HIP is refused, else the site to go on
/// from, out of the solid if `recovering` is false.
struct Begin {
    std::optional<Update> update;
    bool recovering = false;
};
Begin begin_update(Proxy& proxy, const Field& field, const Vec3& hip, const ProxySettings& settings,
                   StepObserver observer);

/// The result for a HIP that is not finite or absurdly far: nothing changed.
ProxyUpdate refuse_update(const Proxy& proxy, const Field& field, const Vec3& hip);

/// How a method's own part ended.
enum class Rest { at_target, on_surface, out_of_budget, recovering };

/// Writes the site back into the proxy and describes the result.
ProxyUpdate finish_update(Proxy& proxy, const Update& update, const Vec3& hip, Rest rest);

/// Brings the site out of the solid: steepest descent of the excess field from tetrahedron to
/// tetrahedron until it is zero; where that gets stuck, the nearest way out along 26 directions.
/// True when out. `reach` is how far the search along the directions came (kept between updates).
bool recover(Site& site, Course& course, double& reach);

}  // namespace palpate
