// Renderer: one tick, from the device's state by HIP, proxy and penetrability to the force.
#include "palpate/renderer.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "proxy/update.hpp"

namespace palpate {
namespace {

/// Scales [physical mm per device mm] and translations [mm] beyond these have no use, and double's
/// range has to hold what follows from them.
constexpr double most_scale = 1e30;
constexpr double farthest_translation = 1e60;

/// Step budget of the magnet's search for a surface.
constexpr int magnet_budget = 512;

/// Distance [physical mm] from a free SCP to the surface, against the normal of the field there;
/// -1 if there is none within `reach`.
double distance_to_surface(const Field& field, const ProxyUpdate& at, const Vec3& normal,
                           double reach) {
    if (normal.isZero(0) || !std::isfinite(at.isovalue)) return -1;
    const RayHit ray = cast_ray(field, at.isovalue, at.scp, at.scp - reach * normal, magnet_budget);
    return ray.hit ? (ray.point - at.scp).norm() : -1;
}

bool knows_layers(ProxyMethod method) {
    return method == &update_exact || method == &update_straight;
}

/// What moved the proxy in a tick, and what the force is made of.
struct Moved {
    ProxyUpdate proxy;
    std::optional<LayersUpdate> layers;
};

ForceInput force_input(const Renderer& renderer, const DeviceState& device, const Moved& moved) {
    const ProxyUpdate& at = moved.proxy;
    const DeviceTransform& transform = renderer.settings.transform;
    const ForceSettings& force = renderer.settings.force;
    const Mat3 to_device = transform.rotation.transpose();
    ForceInput input;
    input.time = device.time;
    input.enabled = renderer.settings.forces_on && device.armed;
    input.released = device.released;
    input.valid = at.status == UpdateStatus::done || at.status == UpdateStatus::out_of_budget;
    input.constrained = at.mode == Mode::constrained;
    input.hand = device.position;
    input.pull = to_device * (at.scp - at.hip) / transform.scale;
    if (moved.layers) {
        input.constrained = moved.layers->pulls;
        input.pull = to_device * moved.layers->pull;
    }
    if (input.constrained) {
        input.texture_slope = to_device * texture_slope(force.texture, at.scp);
    } else if (force.magnet.distance > 0 && force.magnet.peak > 0) {
        const double reach = force.magnet.distance * transform.scale;
        const Vec3 normal = normal_at(renderer.proxy, renderer.field);
        const double distance = distance_to_surface(renderer.field, at, normal, reach);
        input.normal = to_device * normal;
        input.surface_distance = distance / transform.scale;
    }
    return input;
}

/// The proxy's part of a tick, with what may press it through surfaces.
Moved move_proxy(Renderer& renderer, const DeviceState& device, const Vec3& hip,
                 StepObserver observer) {
    const RendererSettings& settings = renderer.settings;
    // A position that is not trusted moves nothing.
    if (!device.valid) return {refuse_update(renderer.proxy, renderer.field, hip), {}};
    if (!settings.layers) {
        return {settings.method(renderer.proxy, renderer.field, hip, settings.proxy, observer), {}};
    }
    const DeviceTransform& transform = settings.transform;
    const LayerInput input{.method = settings.method,
                           .hip = hip,
                           .proxy = settings.proxy,
                           .force = settings.force,
                           .limits = settings.device,
                           .device_per_volume = 1 / transform.scale,
                           .time = device.time,
                           .pointing = transform.rotation * device.pointing};
    Moved moved;
    moved.layers = update_layers(*settings.layers, renderer.layers, renderer.proxy, renderer.field,
                                 input, observer);
    moved.proxy = moved.layers->proxy;
    return moved;
}

}  // namespace

Vec3 physical_from_device(const DeviceTransform& t, const Vec3& device) {
    return t.translation + t.scale * (t.rotation * device);
}

Vec3 device_from_physical(const DeviceTransform& t, const Vec3& physical) {
    return t.rotation.transpose() * (physical - t.translation) / t.scale;
}

double scale_for_voxels_per_mm(const Geometry& geometry, double voxels) {
    return voxels * geometry.spacing.minCoeff();
}

void check(const RendererSettings& s) {
    if (!s.method) throw std::invalid_argument("no proxy method is set");
    check(s.force, s.device);
    if (s.layers && !s.layers->layers.empty() && !knows_layers(s.method)) {
        throw std::invalid_argument("layers need the method exact");
    }
    if (s.layers && s.layers->by_label && !s.layers->labels) {
        throw std::invalid_argument("these layers are by label: name a label volume");
    }
    const auto& ranges = s.penetrability.ranges;
    const bool falling = s.penetrability.range_count > 1 && ranges[1].low < ranges[0].low;
    check(s.penetrability, falling ? Solid::below : Solid::above);
    const Friction& friction = s.proxy.friction;
    if (!(friction.dynamic_coefficient >= 0) ||
        !(friction.static_coefficient >= friction.dynamic_coefficient) ||
        !std::isfinite(friction.static_coefficient)) {
        throw std::invalid_argument(
            "friction: needs 0 <= dynamic coefficient <= static coefficient");
    }
    if (s.proxy.step_budget < 1) throw std::invalid_argument("the step budget must be at least 1");
    const Mat3 r = s.transform.rotation.transpose() * s.transform.rotation - Mat3::Identity();
    // maxCoeff() alone may pass over a NaN.
    if (!r.allFinite() || r.cwiseAbs().maxCoeff() >= 1e-6) {
        throw std::invalid_argument("device transform: rotation must be orthonormal");
    }
    const Vec3& translation = s.transform.translation;
    if (!translation.allFinite() || translation.cwiseAbs().maxCoeff() > farthest_translation) {
        throw std::invalid_argument("device transform: translation must be within 1e60 mm");
    }
    if (!(s.transform.scale >= 1 / most_scale && s.transform.scale <= most_scale)) {
        throw std::invalid_argument(
            "device transform: scale must be finite and above 0, from 1e-30 to 1e30");
    }
}

void check_isovalue(double isovalue, Solid solid) {
    const double s = solid == Solid::above ? 1 : -1;
    if (!(s * isovalue > -std::numeric_limits<double>::infinity())) {
        throw std::invalid_argument(
            "the isovalue is not a number, or infinite so that all of space is solid");
    }
}

Renderer make_renderer(Field field, double isovalue, const RendererSettings& settings) {
    check(settings);
    check(settings.penetrability, field.solid());
    if (settings.layers) check(*settings.layers, field.solid());
    check_isovalue(isovalue, field.solid());
    Renderer renderer{std::move(field), settings, {}, {}};
    renderer.proxy.isovalue = isovalue;
    return renderer;
}

std::string isovalue_warning(const Field& field, double isovalue) {
    const Volume& volume = field.volume();
    const double s = field.sign();
    const double most = s > 0 ? volume.maximum() : volume.minimum();
    if (s * isovalue >= s * most && s * isovalue >= s * field.background()) {
        return "the isovalue lies outside the data's range: nothing is solid, there is nothing to "
               "feel";
    }
    if (s * isovalue < s * field.background()) {
        return "the background outside the data is solid at this isovalue: all of space outside "
               "the data will be felt as solid (choose another isovalue or background)";
    }
    return {};
}

Tick render(Renderer& renderer, const DeviceState& device, StepObserver observer, Clock clock) {
    const RendererSettings& settings = renderer.settings;
    const Vec3 hip = physical_from_device(settings.transform, device.position);
    Tick tick;
    tick.time = device.time;
    const std::int64_t begin = clock ? clock() : 0;
    const Proxy before = renderer.proxy;
    Moved moved = move_proxy(renderer, device, hip, observer);
    if (!is_finite(renderer.proxy)) {
        renderer.proxy = before;
        renderer.layers = {};
        moved = {refuse_update(before, renderer.field, hip, UpdateStatus::not_finite), {}};
    }
    tick.update_ns = clock ? clock() - begin : 0;
    const bool has_surfaces = settings.layers && !settings.layers->layers.empty();
    if (!has_surfaces) {
        apply_penetrability(settings.penetrability, renderer.field, 1 / settings.transform.scale,
                            renderer.proxy, moved.proxy, observer);
    }
    if (moved.layers && settings.penetrability.on && !has_surfaces) {
        moved.layers->pulls = moved.proxy.mode == Mode::constrained;
        moved.layers->pull = (moved.proxy.scp - moved.proxy.hip) / settings.transform.scale;
    }
    const ForceResult force =
        render_force(renderer.force, moved.layers ? moved.layers->force : settings.force,
                     settings.device, force_input(renderer, device, moved));
    tick.proxy = moved.proxy;
    if (moved.layers) tick.layers = moved.layers->felt;
    tick.force = force.force;
    tick.force_flags = force.flags;
    if (tick.proxy.status == UpdateStatus::not_finite) tick.force_flags |= force_not_finite;
    return tick;
}

}  // namespace palpate
