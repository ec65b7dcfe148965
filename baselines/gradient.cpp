// Gradient-based baselines, deliberately as weak as published, since the exact method is compared
// with them.
#include "baselines/gradient.hpp"

#include <cmath>

namespace palpate::baselines {
namespace {

constexpr int bisections = 30;
constexpr int newton_steps = 8;

/// How far a physical point is in the solid, in density; <= 0 is free.
double excess(const Field& field, double isovalue, const Vec3& physical) {
    return field.sign() * (value_at(field, physical) - isovalue);
}

/// First contact between a free point and one in the solid.
Vec3 bisect(const Field& field, double isovalue, Vec3 free, Vec3 solid) {
    for (int i = 0; i < bisections; ++i) {
        const Vec3 middle = 0.5 * (free + solid);
        (excess(field, isovalue, middle) > 0 ? solid : free) = middle;
    }
    return free;
}

Vec3 reprojected(const Field& field, double isovalue, Vec3 point) {
    for (int i = 0; i < newton_steps; ++i) {
        const Vec3 gradient = field.sign() * gradient_at(field, point);
        const double steepness = gradient.squaredNorm();
        if (!(steepness > 0)) break;
        point -= gradient * (excess(field, isovalue, point) / steepness);
    }
    return point;
}

/// The HIP projected on the plane through the SCP across the gradient, if it lies behind it.
Vec3 constrained(const Field& field, const Vec3& scp, const Vec3& hip) {
    const Vec3 gradient = field.sign() * gradient_at(field, scp);
    const double into = gradient.dot(hip - scp);
    if (!(into > 0)) return hip;
    return hip - gradient * (into / gradient.squaredNorm());
}

bool accepts(const Field& field, const Vec3& physical) {
    const Vec3 index = index_from_physical(field.geometry(), physical);
    return index.cwiseAbs().maxCoeff() <= farthest_index;
}

ProxyUpdate update(Proxy& proxy, const Field& field, const Vec3& hip, bool improved,
                   StepObserver observer) {
    ProxyUpdate result;
    result.hip = hip;
    result.isovalue = proxy.isovalue;
    const bool accepted = accepts(field, hip) && !std::isnan(proxy.isovalue);
    if (accepted) {
        const bool free = !(excess(field, proxy.isovalue, hip) > 0);
        Vec3 scp = hip;
        if (!free && proxy.placed) {
            scp = proxy.mode == Mode::constrained
                      ? constrained(field, proxy.scp_physical, hip)
                      : bisect(field, proxy.isovalue, proxy.scp_physical, hip);
            if (improved) scp = reprojected(field, proxy.isovalue, scp);
            if (!accepts(field, scp)) scp = proxy.scp_physical;  // a flat gradient threw it away
        }
        proxy.placed = true;
        proxy.mode = free ? Mode::free : Mode::constrained;
        proxy.scp_physical = scp;
        proxy.interpolation = field.interpolation();
        proxy.scp = locate(proxy.interpolation, index_from_physical(field.geometry(), scp));
        result.tetrahedra = 1;
    }
    result.status = accepted ? UpdateStatus::done : UpdateStatus::refused;
    result.mode = proxy.mode;
    result.scp = proxy.scp_physical;
    result.density = proxy.placed ? value_at(field, proxy.scp_physical) : 0;
    if (accepted && observer.on_step) {
        const StepKind kind = result.mode == Mode::free ? StepKind::free_move : StepKind::slide;
        observer.on_step({kind, result.scp, hip, proxy.scp.tetrahedron}, observer.context);
    }
    return result;
}

}  // namespace

ProxyUpdate update_gradient(Proxy& proxy, const Field& field, const Vec3& hip,
                            const ProxySettings& /*no friction*/, StepObserver observer) {
    return update(proxy, field, hip, false, observer);
}

ProxyUpdate update_gradient_improved(Proxy& proxy, const Field& field, const Vec3& hip,
                                     const ProxySettings& /*no friction*/, StepObserver observer) {
    return update(proxy, field, hip, true, observer);
}

}  // namespace palpate::baselines
