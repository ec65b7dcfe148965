// The proxy that does not slide.
#include "proxy/update.hpp"

namespace palpate {

ProxyUpdate update_straight(Proxy& proxy, const Field& field, const Vec3& hip,
                            const ProxySettings& settings, StepObserver observer) {
    const auto go = [](auto& site, Progress& progress) {
        const WalkEnd end = walk_to(site, progress.target, progress);
        progress.report(StepKind::free_move, site);
        return end == WalkEnd::target    ? Rest::at_target
               : end == WalkEnd::surface ? Rest::on_surface
                                         : Rest::out_of_budget;
    };
    return field.interpolation() == Interpolation::cubic
               ? update_by<CubicSite>(proxy, field, hip, settings, observer, go)
               : update_by<Site>(proxy, field, hip, settings, observer, go);
}

}  // namespace palpate
