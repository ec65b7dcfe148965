// Renderer: one tick, from the device's state by HIP, proxy and penetrability to the force.
#include "palpate/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "layers/stretch.hpp"
#include "proxy/update.hpp"
#include "reach.hpp"
#include "tool_proxy/kept.hpp"

namespace palpate {
namespace {

/// A tool's metric differs from its own by no more than this: beyond, one of the springs is nothing
/// beside the other.
constexpr double most_gyration_ratio = 1e3;

bool knows_layers(ProxyMethod method) {
    return method == &update_exact || method == &update_straight;
}

/// Whether a force may follow from an update that ended like this.
bool counts(UpdateStatus status) {
    return status == UpdateStatus::done || status == UpdateStatus::out_of_budget ||
           status == UpdateStatus::waiting;
}

/// Step budget of the magnet's search for a surface, and of the way along it.
constexpr int magnet_budget = 512;

/// The point of the surface [physical mm] that draws a free SCP, if it is within `reach`. Without a
/// last one it is looked for against the normal of the field. From there, a proxy that may not
/// leave the solid comes as near as it can. So the magnet pulls along the gradient of its distance,
/// to the same surface until it lets go, and closed paths of the hand gain nothing.
std::optional<Vec3> drawing_point(const Renderer& renderer, const ProxyUpdate& at, double reach) {
    const Field& field = felt_field(renderer);
    if (!std::isfinite(at.isovalue) || !is_resident(renderer.field, at.scp, reach)) {
        return std::nullopt;
    }
    std::optional<Vec3> from = renderer.drawn_to;
    if (!from) {
        const Vec3 normal = normal_at(renderer.proxy, field);
        if (normal.isZero(0)) return std::nullopt;
        const RayHit ray =
            cast_ray(field, at.isovalue, at.scp, at.scp - reach * normal, magnet_budget);
        if (ray.hit) from = ray.point;
    }
    if (!from || !((*from - at.scp).norm() < reach)) return std::nullopt;
    Proxy in_solid;
    in_solid.isovalue = field.sign() * std::numeric_limits<double>::infinity();
    in_solid.behind = at.isovalue;
    in_solid.scp_physical = *from;
    in_solid.placed = true;
    put_on_lattice(in_solid, field);
    const ProxyUpdate nearest =
        update_exact(in_solid, field, at.scp, {.step_budget = magnet_budget});
    return counts(nearest.status) ? std::optional(nearest.scp) : std::nullopt;
}

/// The result of moving the proxy in a tick, from which the force follows.
struct Moved {
    ProxyUpdate proxy;
    std::optional<LayersUpdate> layers;
};

/// [N mm/rad] With this the tool's turn is rendered, and its proxy found.
double turning_of(const RendererSettings& settings) {
    const double gyration = settings.tool->gyration() / settings.transform.scale;
    return rotational_stiffness(settings.force, settings.device, gyration);
}

/// Input of the force, with a point, with layers or with a tool.
ForceInput force_input(Renderer& renderer, const TickInput& device, const Tick& tick,
                       const std::optional<LayersUpdate>& layers) {
    const ProxyUpdate& at = tick.proxy;
    const RendererSettings& settings = renderer.settings;
    const DeviceTransform& transform = settings.transform;
    const Mat3 to_device = transform.rotation.transpose();
    const bool waits = at.status == UpdateStatus::waiting;
    ForceInput input;
    input.time = device.time;
    input.enabled = settings.forces_on && device.armed;
    input.released = device.released;
    input.valid = counts(at.status);
    input.constrained = (layers ? layers->pulls : pulls(at)) && !waits;
    input.hand = device.position;
    if (settings.tool) {
        input.rotational_stiffness = settings.tool->turns() ? turning_of(settings) : 0;
        input.orientation = Quaternion(device.orientation);
        input.turn = to_device * rotation_between(tick.tool.hand, tick.tool.proxy);
    }
    if (waits) return input;
    input.pull = layers ? Vec3(to_device * layers->pull)
                        : Vec3(to_device * (at.scp - at.hip) / transform.scale);
    if (settings.tool) return input;
    const Magnet& magnet = settings.force.magnet;
    const bool draws = magnet.distance > 0 && magnet.peak > 0;
    if (input.constrained) {
        input.texture_slope = to_device * texture_slope(settings.force.texture, at.scp);
        renderer.drawn_to = at.behind ? std::nullopt : std::optional(at.scp);
    } else if (draws) {
        renderer.drawn_to = drawing_point(renderer, at, magnet.distance * transform.scale);
    }
    if (!draws) renderer.drawn_to.reset();
    if (input.constrained || !renderer.drawn_to) return input;
    const Vec3 way = at.scp - *renderer.drawn_to;
    const double distance = way.norm();
    if (distance > 0) input.normal = to_device * way / distance;
    input.surface_distance = distance / transform.scale;
    return input;
}

/// Layers set the proxy's level; the isovalue waits for their end. What other layers knew does not
/// count.
void look_at_layers(Renderer& renderer) {
    const bool by_set = !renderer.settings.tool && renderer.layers.set == renderer.settings.layers;
    if (renderer.layers.set && !by_set) {
        forget_layers(renderer.layers, renderer.proxy, renderer.field);
    }
    auto& waiting = renderer.isovalue_without_layers;
    const bool by_layers = have_surfaces(renderer.settings.layers) && !renderer.settings.tool;
    if (by_layers == waiting.has_value()) return;
    if (by_layers) {
        waiting = renderer.proxy.isovalue;
    } else {
        renderer.proxy.isovalue = *waiting;
        waiting.reset();
    }
}

/// After an update from a place before which the proxy was placed, or not.
void note_start(Renderer& renderer, bool was_placed, UpdateStatus status) {
    if (counts(status)) renderer.starts_inside = false;
    if (!was_placed && status == UpdateStatus::recovering) renderer.starts_inside = true;
}

/// An update that leaves the proxy where it is, because samples are missing. A hand that was put
/// into the solid is followed: it may come out where samples are in memory, or where they come.
ProxyUpdate wait_for_samples(Renderer& renderer, const Vec3& hip) {
    if (renderer.starts_inside) renderer.proxy.placed = false;
    ProxyUpdate held =
        refuse_update(renderer.proxy, felt_field(renderer), hip, UpdateStatus::waiting);
    if (!renderer.proxy.placed) held.scp = hip;
    return held;
}

/// Recovery is bound to no ball that was found in memory before. What it found does not count where
/// nearer samples are not there: it looks again when they are. True if the point, which was at
/// `before` and should go to `hip`, has to wait.
bool looked_beyond_memory(Renderer& renderer, const Proxy& before, const Vec3& hip,
                          double searched) {
    const Vec3& from = before.placed ? before.scp_physical : hip;
    if (!(searched > 0) || is_resident(renderer.field, from, searched)) return false;
    renderer.proxy = before;
    renderer.proxy.recovery_reach = 0;
    return true;
}

/// Layers move the proxy from where the hand was, too.
Pull pull_of(const Renderer& renderer, const Vec3& hip) {
    Pull pull{renderer.proxy.placed ? renderer.proxy.scp_physical : hip, hip};
    if (renderer.settings.layers && renderer.layers.moved) {
        pull.arm = (hip - renderer.layers.hip).norm();
    }
    return pull;
}

/// The proxy's part of a tick, with what may press it through surfaces.
Moved move_proxy(Renderer& renderer, const TickInput& device, const Vec3& hip, const Proxy& before,
                 StepObserver observer) {
    const RendererSettings& settings = renderer.settings;
    // A position that is not trusted moves nothing.
    if (!device.valid) return {refuse_update(renderer.proxy, felt_field(renderer), hip), {}};
    const double part = part_within_reach(renderer.field, pull_of(renderer, hip));
    if (part == 0 || (part < 1 && (settings.layers || settings.penetrability.on))) {
        return {wait_for_samples(renderer, hip), {}};
    }
    Moved moved{};
    if (settings.layers) {
        DeviceLimits limits = settings.device;
        const double held = settings.force.stale_after;
        limits.maximum_force =
            warm_limit(limits, warmed(renderer.force.motors, limits, device.time, held));
        const DeviceTransform& transform = settings.transform;
        const LayerInput input{.method = settings.method,
                               .hip = hip,
                               .proxy = settings.proxy,
                               .force = settings.force,
                               .limits = limits,
                               .device_per_volume = 1 / transform.scale,
                               .time = device.time,
                               .pointing = transform.rotation * device.pointing};
        moved.layers = update_layers(settings.layers, renderer.layers, renderer.proxy,
                                     renderer.field, input, observer);
        moved.proxy = moved.layers->proxy;
    } else {
        const Vec3 from = before.placed ? before.scp_physical : hip;
        const Vec3 goal = part == 1 ? hip : Vec3(from + part * (hip - from));
        moved.proxy =
            settings.method(renderer.proxy, renderer.field, goal, settings.proxy, observer);
        moved.proxy.hip = hip;
        const bool arrived = moved.proxy.mode == Mode::free && counts(moved.proxy.status);
        if (part < 1 && arrived) moved.proxy.status = UpdateStatus::waiting;
    }
    if (looked_beyond_memory(renderer, before, hip, moved.proxy.searched)) {
        forget_layers(renderer.layers, renderer.proxy, renderer.field);
        return {wait_for_samples(renderer, hip), {}};
    }
    note_start(renderer, before.placed, moved.proxy.status);
    return moved;
}

/// The tool's proxy towards the hand's pose, as far as samples are in memory.
ToolUpdate move_tool(Renderer& renderer, const Pose& hand, const ToolSettings& asked,
                     PoseObserver observer) {
    ToolProxy& proxy = *renderer.tool_proxy;
    const bool was_placed = proxy.placed;
    const Pose from = was_placed ? proxy.pose : hand;
    const double gyration = asked.gyration > 0 ? asked.gyration : proxy.tool().gyration();
    const Vec3 turn = rotation_between(from.orientation, hand.orientation);
    const double part = part_within_reach(
        renderer.field,
        {from.position, hand.position, gyration * turn.norm(), proxy.tool().radius()});
    ToolUpdate update{
        .status = UpdateStatus::waiting, .mode = proxy.mode, .hand = hand, .proxy = from};
    if (part == 0) {
        proxy.placed = was_placed && !renderer.starts_inside;
        return update;
    }
    Pose goal = hand;
    if (part < 1) {
        goal.position = from.position + part * (hand.position - from.position);
        goal.orientation = from.orientation.slerp(part, hand.orientation).normalized();
    }
    update = update_tool(proxy, renderer.field, goal, asked, observer);
    update.hand = hand;
    if (update.searched > 0 &&
        !is_resident(renderer.field, from.position, update.searched + proxy.tool().radius())) {
        proxy.pose = update.proxy = from;
        proxy.placed = was_placed && !renderer.starts_inside;
        proxy.contact_count = 0;
        proxy.kept().inside = true;
        proxy.kept().recovery = {};
        update.status = UpdateStatus::waiting;
        return update;
    }
    note_start(renderer, was_placed, update.status);
    if (part < 1 && update.mode == Mode::free && counts(update.status)) {
        update.status = UpdateStatus::waiting;
    }
    return update;
}

/// The proxy's part of a tick of a tool: six degrees of freedom.
void feel_with_tool(Renderer& renderer, const TickInput& device, Tick& tick,
                    PoseObserver observer) {
    const RendererSettings& settings = renderer.settings;
    const DeviceTransform& transform = settings.transform;
    ToolProxy& proxy = *renderer.tool_proxy;
    const double turning = turning_of(settings), stiffness = settings.force.stiffness;
    ToolSettings asked{.friction = settings.proxy.friction,
                       .work_budget = settings.proxy.step_budget};
    // With this the proxy's pose is the equilibrium of the springs that are rendered.
    if (stiffness > 0 && turning > 0) {
        const double own = settings.tool->gyration();
        asked.gyration = std::clamp(transform.scale * std::sqrt(turning / stiffness),
                                    own / most_gyration_ratio, own * most_gyration_ratio);
    }
    const Pose hand{physical_from_device(transform, device.position),
                    Quaternion(transform.rotation * device.orientation).normalized()};
    proxy.isovalue = renderer.proxy.isovalue;
    ToolUpdate update{
        .status = UpdateStatus::refused, .mode = proxy.mode, .hand = hand, .proxy = proxy.pose};
    // A pose that is not trusted moves nothing.
    if (device.valid) update = move_tool(renderer, hand, asked, observer);
    tick.proxy.status = update.status;
    tick.proxy.mode = update.mode;
    tick.proxy.hip = update.hand.position;
    tick.proxy.scp = update.proxy.position;
    tick.proxy.isovalue = proxy.isovalue;
    tick.proxy.tetrahedra = tick.proxy.work = update.work;
    if (proxy.placed) tick.proxy.density = value_at(renderer.field, update.proxy.position);
    tick.tool = {update.hand.orientation, update.proxy.orientation, update.contacts};
}

/// The same for a point, with layers or without.
std::optional<LayersUpdate> feel_with_point(Renderer& renderer, const TickInput& device, Tick& tick,
                                            StepObserver observer) {
    const RendererSettings& settings = renderer.settings;
    const Vec3 hip = physical_from_device(settings.transform, device.position);
    const Proxy before = renderer.proxy;
    Moved moved = move_proxy(renderer, device, hip, before, observer);
    if (!is_finite(renderer.proxy)) {
        renderer.proxy = before;
        forget_layers(renderer.layers, renderer.proxy, renderer.field);
        moved = {refuse_update(renderer.proxy, renderer.field, hip, UpdateStatus::not_finite), {}};
    }
    tick.proxy = moved.proxy;
    return moved.layers;
}

}  // namespace

Vec3 physical_from_device(const DeviceTransform& t, const Vec3& device) {
    return t.translation + t.scale * (t.rotation * device);
}

Vec3 device_from_physical(const DeviceTransform& t, const Vec3& physical) {
    return t.rotation.transpose() * (physical - t.translation) / t.scale;
}

static void check_with_tool(const RendererSettings& s) {
    const char* wrong = s.layers                         ? "layers"
                        : s.penetrability.on             ? "penetrability"
                        : s.force.magnet.distance > 0    ? "a magnet"
                        : s.force.texture.amplitude != 0 ? "a texture"
                                                         : nullptr;
    if (wrong) {
        throw std::invalid_argument("a tool cannot be combined with " + std::string(wrong) +
                                    ": use only one of the two");
    }
}

void check(const RendererSettings& s) {
    if (!s.method) throw std::invalid_argument("no proxy method is set");
    check(s.force, s.device);
    if (have_surfaces(s.layers) && !knows_layers(s.method)) {
        throw std::invalid_argument("layers need the method exact");
    }
    if (s.tool) check_with_tool(s);
    if (s.layers && s.layers->by_label && !s.layers->labels) {
        throw std::invalid_argument("these layers are by label: name a label volume");
    }
    const auto& ranges = s.penetrability.ranges;
    const bool falling = s.penetrability.range_count > 1 && ranges[1].low < ranges[0].low;
    check(s.penetrability, falling ? Solid::below : Solid::above);
    for (const Friction& friction : {s.proxy.friction, s.proxy.behind}) {
        if (!(friction.dynamic_coefficient >= 0) ||
            !(friction.static_coefficient >= friction.dynamic_coefficient) ||
            !std::isfinite(friction.static_coefficient)) {
            throw std::invalid_argument(
                "friction: needs 0 <= dynamic coefficient <= static coefficient");
        }
    }
    if (s.proxy.step_budget < 1) throw std::invalid_argument("the step budget must be at least 1");
    check_ranges(s.transform);
    if (!is_rotation(s.transform.rotation)) {
        throw std::invalid_argument(
            "device transform: rotation must be orthonormal and must not mirror");
    }
}

FieldKind kind_of(const Field& field) {
    return {field.geometry(), field.solid(), field.interpolation()};
}

void check_tool(const Tool* tool, ProxyMethod method, const FieldKind& field) {
    if (!tool) return;
    if (field.interpolation != Interpolation::cubic) {
        throw std::invalid_argument(
            "tools need the cubic field: a linear one can be touched only with a point");
    }
    if (method != &update_exact) throw std::invalid_argument("tools need the method exact");
}

void check_isovalue(double isovalue, Solid solid) {
    const double s = solid == Solid::above ? 1 : -1;
    if (!(s * isovalue > -std::numeric_limits<double>::infinity())) {
        throw std::invalid_argument(
            "the isovalue is not a number, or infinite so that all of space is solid");
    }
}

void check(const Renderer& renderer) {
    const RendererSettings& settings = renderer.settings;
    const Solid solid = renderer.field.solid();
    check(settings);
    check(settings.penetrability, solid);
    if (settings.layers) check(*settings.layers, solid);
    check_isovalue(renderer.isovalue_without_layers.value_or(renderer.proxy.isovalue), solid);
    check_tool(settings.tool.get(), settings.method, kind_of(renderer.field));
}

Renderer make_renderer(Field field, double isovalue, const RendererSettings& settings) {
    Renderer renderer{std::move(field), settings, {}, {}};
    renderer.proxy.isovalue = isovalue;
    check(renderer);
    if (settings.tool) renderer.tool_proxy.emplace(settings.tool);
    return renderer;
}

void use_isovalue(Renderer& renderer, double isovalue) noexcept {
    auto& waiting = renderer.isovalue_without_layers;
    (waiting ? *waiting : renderer.proxy.isovalue) = isovalue;
}

void make_room_for_tools(Renderer& renderer) {
    std::optional<ToolProxy>& proxy = renderer.tool_proxy;
    if (!proxy) proxy.emplace(std::make_shared<const Tool>(point_tool()));
    proxy->make_room(most_tool_points);
}

void use_tool(Renderer& renderer, std::shared_ptr<const Tool> tool,
              const Mat3& orientation) noexcept {
    RendererSettings& settings = renderer.settings;
    std::optional<ToolProxy>& proxy = renderer.tool_proxy;
    if (tool && !(proxy && proxy->use(tool))) return;
    forget_layers(renderer.layers, renderer.proxy, renderer.field);
    if (tool && !settings.tool) {
        static_cast<ToolState&>(*proxy) = {};  // what it was when it was used last does not count
        proxy->pose = {renderer.proxy.scp_physical,
                       Quaternion(settings.transform.rotation * orientation).normalized()};
        proxy->placed = renderer.proxy.placed;
    }
    if (!tool && settings.tool) {
        // The point starts where the tool was, and is brought out there if that is inside.
        Proxy point;
        point.isovalue = renderer.proxy.isovalue;
        point.placed = proxy->placed;
        point.scp_physical = proxy->pose.position;
        put_on_lattice(point, renderer.field);
        renderer.proxy = point;
        proxy->kept().surroundings.samples.reset();  // nobody feels them
    }
    settings.tool = std::move(tool);
    renderer.force.waiting = true;
}

void lift(Renderer& renderer) noexcept {
    forget_layers(renderer.layers, renderer.proxy, renderer.field);
    Proxy anew;
    anew.isovalue = renderer.proxy.isovalue;
    renderer.proxy = anew;
    if (renderer.tool_proxy) renderer.tool_proxy->placed = false;
    renderer.force.waiting = true;
}

std::string isovalue_warning(const Field& field, double isovalue) {
    const Samples& samples = field.samples();
    const double s = field.sign();
    const double most = s > 0 ? samples.maximum() : samples.minimum();
    if (s * isovalue >= s * most && s * isovalue >= s * field.background()) {
        return "the isovalue lies outside the data's range: nothing is solid, so there is "
               "nothing to touch";
    }
    if (s * isovalue < s * field.background()) {
        return "the background outside the data is solid at this isovalue: all of space outside "
               "the data will be solid (choose another isovalue or background)";
    }
    return {};
}

Tick render(Renderer& renderer, const TickInput& device, StepObserver observer, Clock clock,
            PoseObserver pose_observer) {
    const RendererSettings& settings = renderer.settings;
    look_at_layers(renderer);
    Tick tick;
    tick.time = device.time;
    std::optional<LayersUpdate> layers;
    const std::int64_t begin = clock ? clock() : 0;
    if (settings.tool) {
        feel_with_tool(renderer, device, tick, pose_observer);
    } else {
        layers = feel_with_point(renderer, device, tick, observer);
    }
    tick.update_ns = clock ? clock() - begin : 0;
    const bool waits = tick.proxy.status == UpdateStatus::waiting;
    const Vec3 scp = tick.proxy.scp;
    const Penetrability& penetrability = settings.penetrability;
    if (penetrability.on && !settings.tool && !have_surfaces(settings.layers) && !waits) {
        apply_penetrability(penetrability, renderer.field, 1 / settings.transform.scale,
                            renderer.proxy, tick.proxy, observer);
        if (layers && tick.proxy.status == UpdateStatus::done) {
            stretch_again(renderer.layers.spring, tick.proxy, settings.transform.scale, *layers);
        }
    }
    const bool changed = renderer.force.changed;
    const bool goes_on = tick.proxy.status != UpdateStatus::done || tick.proxy.scp != scp;
    const ForceResult force =
        render_force(renderer.force, layers ? layers->force : settings.force, settings.device,
                     force_input(renderer, device, tick, layers));
    // Samples that arrive change the contact. A change goes on while the proxy has not got where it
    // leads: after an update out of budget, or pressed through a surface.
    renderer.force.changed = waits || (changed && goes_on);
    if (renderer.layers.covered) tick.proxy.density = value_at(renderer.field, tick.proxy.scp);
    tick.proxy.level = level_at(renderer.field, tick.proxy.scp);
    if (layers) tick.layers = layers->felt;
    tick.force = force.force;
    tick.torque = force.torque;
    tick.force_flags = force.flags;
    if (tick.proxy.status == UpdateStatus::not_finite) tick.force_flags |= force_not_finite;
    return tick;
}

}  // namespace palpate
