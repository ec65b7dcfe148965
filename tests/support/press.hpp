// A hand that presses with penetrability: proxy update and penetrability stage, as in a tick.
#pragma once

#include <limits>
#include <vector>

#include "palpate/proxy.hpp"
#include "palpate/renderer.hpp"
#include "support/fields.hpp"

namespace palpate::support {

/// Density = z [voxel, mm], so that where a level lies can be read off: z in 0..100, 9 x 9 wide.
inline Field ramp_field(Solid solid = Solid::above) {
    const double sign = solid == Solid::above ? 1 : -1;
    return linear_field(
        volume_of<float>(grid({9, 9, 101}), [&](const Index3& i) { return sign * i[2]; }), solid);
}

/// A point on the ramp's axis.
inline Vec3 at_depth(double z) {
    return {4.2, 3.9, z};
}

/// No ramp and no rate limit: the force of a period is what its positions say.
inline RendererSettings at_once() {
    RendererSettings settings;
    settings.force.ramp = 0;
    settings.force.rate_limit = std::numeric_limits<double>::infinity();
    return settings;
}

struct Press {
    Field field;
    Penetrability penetrability;
    Proxy proxy{};
    double device_per_volume = 1;
    ProxyMethod method = &update_exact;
    ProxySettings settings{};
    std::vector<Step> path{};  ///< of the last tick

    Press(Field f, double isovalue, const Penetrability& p)
        : field(std::move(f)), penetrability(p) {
        proxy.isovalue = isovalue;
    }

    ProxyUpdate to(const Vec3& hip) {
        path.clear();
        const StepObserver observer{[](const Step& step, void* to) {
                                        static_cast<std::vector<Step>*>(to)->push_back(step);
                                    },
                                    &path};
        ProxyUpdate update = method(proxy, field, hip, settings, observer);
        apply_penetrability(penetrability, field, device_per_volume, proxy, update, observer);
        return update;
    }
};

inline double pull_of(const ProxyUpdate& update) {
    return (update.scp - update.hip).norm();
}

}  // namespace palpate::support
