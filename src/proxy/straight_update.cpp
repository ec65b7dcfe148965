// The proxy that does not slide.
#include "proxy/update.hpp"

namespace palpate {
namespace {

template <class AnySite>
ProxyUpdate update_on(Proxy& proxy, const Field& field, const Vec3& hip, const Vec3& target,
                      const ProxySettings& settings, StepObserver observer) {
    Update<AnySite> update(proxy, field, target, settings, observer);
    if (update.recovering) return finish_update(proxy, update, hip, Rest::recovering);
    const WalkEnd end = walk_to(update.site, target, update.progress);
    update.progress.report(StepKind::free_move, update.site);
    return finish_update(proxy, update, hip,
                         end == WalkEnd::target    ? Rest::at_target
                         : end == WalkEnd::surface ? Rest::on_surface
                                                   : Rest::out_of_budget);
}

}  // namespace

ProxyUpdate update_straight(Proxy& proxy, const Field& field, const Vec3& hip,
                            const ProxySettings& settings, StepObserver observer) {
    const Vec3 target = index_from_physical(field.geometry(), hip);
    if (!accepts(proxy.isovalue, field, target)) return refuse_update(proxy, field, hip);
    const auto update =
        field.interpolation() == Interpolation::cubic ? update_on<CubicSite> : update_on<Site>;
    return update(proxy, field, hip, target, settings, observer);
}

}  // namespace palpate
