// Takes the state out of a session that follows from neither settings nor samples, and puts it
// back.
#include "session/session_point.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include "layers/tissues.hpp"
#include "tool_proxy/kept.hpp"

namespace palpate {
namespace {

/// The first ones of an array, which are in use.
auto in_use(const auto& array, int count) {
    return std::span(array).first(static_cast<std::size_t>(count));
}

/// Drops the results of a tool's proxy that only save time.
void drop_kept(ToolProxy& proxy) noexcept {
    tool::Kept& kept = proxy.kept();
    kept.renewed = true;
    kept.inside = false;
    kept.recovery = {};
    kept.surroundings.samples.reset();  // others hold them
}

/// For a proxy that drop_kept() has left or that is new.
void resume_tool(ToolProxy& proxy, const ToolState& state) noexcept {
    static_cast<ToolState&>(proxy) = state;
    // The tool may be another one than that of the check.
    const auto is_of_tool = [&](const ToolContact& contact) {
        return static_cast<std::size_t>(contact.point) < proxy.tool().points().size();
    };
    if (!std::ranges::all_of(in_use(state.contacts, state.contact_count), is_of_tool)) {
        proxy.contact_count = 0;
    }
}

/// [s] The hand may have moved meanwhile for so long.
constexpr double longest_change = 1;

void require(bool is_so, const char* what) {
    if (!is_so) throw std::invalid_argument(std::string("the point at which to continue: ") + what);
}

bool is_number(double value) {
    return !std::isnan(value);
}
bool is_unit(const Quaternion& q) {
    return std::abs(q.squaredNorm() - 1) < 1e-6;  // false for NaN
}

bool is_place(const LatticePoint& point) {
    const Tetrahedron& t = point.tetrahedron;
    std::array<std::int8_t, 3> axes = t.axis;
    std::ranges::sort(axes);
    const bool has_frame = axes == std::array<std::int8_t, 3>{0, 1, 2} &&
                           std::ranges::all_of(t.sign, [](int s) { return s == 1 || s == -1; });
    const Vec3& u = point.folded;
    return has_frame && t.cell.cwiseAbs().maxCoeff() <= farthest_index && u.allFinite() &&
           u[0] <= 0.5 && u[1] <= u[0] && std::abs(u[2]) <= u[1];
}

/// Near enough to be computed with [mm].
bool is_within(const Vec3& v, double farthest) {
    return v.allFinite() && v.cwiseAbs().maxCoeff() <= farthest;
}
bool is_near(const Vec3& physical, const Geometry& grid) {
    return physical.allFinite() &&
           is_within(index_from_physical(grid, physical), 10 * farthest_hip);
}

bool is_possible(const HandPast& past) {
    return std::isfinite(past.last_tick) && std::isfinite(past.seen_at) &&
           is_within(past.hand, farthest_hand) && is_within(past.frozen_hand, farthest_hand) &&
           is_within(past.held_hip, 1e60) && is_rotation(past.tool) &&
           is_rotation(past.frozen_tool) && is_rotation(past.held_tool);
}

bool is_possible(const ToolState& state, const Tool* tool, const Geometry& grid) {
    const int points = tool ? static_cast<int>(tool->points().size()) : 0;
    const auto is_contact = [&](const ToolContact& contact) {
        return contact.point >= 0 && contact.point < points && is_near(contact.place, grid) &&
               is_within(contact.normal, 2) && std::isfinite(contact.pressure);
    };
    return state.contact_count >= 0 && state.contact_count <= most_tool_contacts &&
           std::ranges::all_of(in_use(state.contacts, state.contact_count), is_contact) &&
           state.trust > 0 && state.trust <= 1 && state.stride > 0 && state.stride <= 64 &&
           is_unit(state.pose.orientation) && (!state.placed || is_near(state.pose.position, grid));
}

bool is_finite(const ForceState& force) {
    return std::isfinite(force.time) && std::isfinite(force.ramp_begin) && force.hand.allFinite() &&
           force.velocity.allFinite() && force.force.allFinite() && is_unit(force.orientation) &&
           force.angular_velocity.allFinite() && force.torque.allFinite() &&
           std::isfinite(force.spring) && std::isfinite(force.turning_spring) &&
           force.motors.warmth >= 0 && std::isfinite(force.motors.warmth) &&
           std::isfinite(force.motors.time) && std::isfinite(force.motors.force);
}

bool is_of(const NeedleState& needle, int layers) {
    if (needle.crossing_count < 0 || needle.crossing_count > NeedleState::most_crossings) {
        return false;
    }
    const auto is_crossing = [&](const Crossing& c) {
        return is_number(c.at) && c.surface >= 0 && c.surface < layers && c.layer >= -1 &&
               c.layer < layers;
    };
    return std::ranges::all_of(in_use(needle.crossings, needle.crossing_count), is_crossing) &&
           needle.entry.allFinite() && needle.axis.allFinite() && std::isfinite(needle.hand) &&
           std::isfinite(needle.anchor) && std::isfinite(needle.aside.stiffness) &&
           std::isfinite(needle.aside.rest);
}

bool is_of(const LayerState& state, const Layers* layers) {
    if (state.layer_count < 0) return true;  // of no set
    const int count = layers ? static_cast<int>(layers->layers.size()) : -1;
    const auto all = static_cast<std::uint32_t>((std::uint64_t{2} << std::max(count, 0)) - 1);
    return state.layer_count == count &&
           state.level_count == static_cast<int>(level_count(*layers)) && state.open != 0 &&
           (state.open & ~all) == 0 && state.outer >= 0 && state.outer <= state.inner &&
           state.inner <= state.level_count && state.touched >= -1 && state.touched < count &&
           state.label_opening.allFinite() && state.hip.allFinite() &&
           // The others are not set.
           std::ranges::all_of(in_use(state.opening, state.inner),
                               [](const Vec3& at) { return at.allFinite(); }) &&
           std::isfinite(state.spring.stiffness) && std::isfinite(state.spring.rest) &&
           std::isfinite(state.time) && is_of(state.needle, count);
}

}  // namespace

void checkpoint(Session& session, SessionPoint& point) noexcept {
    Renderer& renderer = session.renderer;
    const RendererSettings& settings = renderer.settings;
    if (std::optional<ToolProxy>& proxy = renderer.tool_proxy) {
        drop_kept(*proxy);
        if (settings.tool) point.tool = *proxy;
        if (!settings.tool) resume_tool(*proxy, {});  // as a new one
    }
    point.moment = renderer.field.time();
    point.speed = session.speed;
    point.frozen = session.frozen;
    point.clutched = session.clutched;
    point.past = session.past;
    renderer.proxy.kept_samples = {};  // a recording does not have them, and budgets count them
    point.starts_inside = renderer.starts_inside;
    point.proxy = renderer.proxy;
    point.isovalue_without_layers = renderer.isovalue_without_layers;
    point.drawn_to = renderer.drawn_to;
    point.force = renderer.force;
    point.layers = renderer.layers.set == settings.layers ? renderer.layers : LayerState{};
    point.layers.covered.reset();
    point.layers.set.reset();
}

void check(const SessionPoint& point, const RendererSettings& settings, const FieldKind& field) {
    require(std::isfinite(point.moment) && std::abs(point.speed) <= 1000,
            "the moment or the speed is out of range");
    require(is_possible(point.past) && is_finite(point.force), "a number is out of range");
    const Proxy& proxy = point.proxy;
    require(!proxy.placed || (is_place(proxy.scp) && is_near(proxy.scp_physical, field.geometry)),
            "the SCP has no place");
    check_isovalue(point.isovalue_without_layers.value_or(proxy.isovalue), field.solid);
    require(is_number(proxy.isovalue) && is_number(proxy.behind.value_or(0)),
            "a level is not a number");
    require(proxy.recovery_reach >= 0 && proxy.recovery_reach <= 1e7 &&
                is_within(proxy.normal_before, 2),
            "the proxy's state is out of range");
    require(!proxy.placed || proxy.interpolation == field.interpolation,
            "the proxy is of another field");
    require(!point.drawn_to || is_near(*point.drawn_to, field.geometry),
            "the magnet's point has no place");
    require(is_of(point.layers, settings.layers.get()), "it is of other layers");
    require(is_possible(point.tool, settings.tool.get(), field.geometry), "the tool has no pose");
}

void take_up(Session& session, const Session& before) {
    session.frozen = before.frozen;
    session.clutched = before.clutched;
    session.past = before.past;
    session.past.begun = false;
    session.past.last_tick = 0;
    session.past.seen_at = -longest_change;
    Renderer& renderer = session.renderer;
    const Renderer& last = before.renderer;
    renderer.force.motors.warmth = last.force.motors.warmth;
    if (renderer.field.solid() != last.field.solid()) return;
    const double isovalue = renderer.proxy.isovalue;
    LayerState layers = last.layers;
    renderer.proxy = last.proxy;
    field_will_change(renderer.proxy, felt_field(last));
    forget_layers(layers, renderer.proxy, last.field);
    renderer.proxy.isovalue = isovalue;
    renderer.proxy.kept_samples = {};
    renderer.starts_inside = last.starts_inside;
    if (renderer.settings.tool && renderer.settings.tool == last.settings.tool) {
        resume_tool(*renderer.tool_proxy, *last.tool_proxy);
    }
}

void resume(Session& session, const SessionPoint& point) noexcept {
    Renderer& renderer = session.renderer;
    const RendererSettings& settings = renderer.settings;
    renderer.field.set_time(renderer.field.samples().within(point.moment));
    session.speed = point.speed;
    session.frozen = point.frozen;
    session.clutched = point.clutched;
    session.past = point.past;
    renderer.proxy = point.proxy;
    renderer.starts_inside = point.starts_inside;
    renderer.isovalue_without_layers = point.isovalue_without_layers;
    renderer.drawn_to = point.drawn_to;
    renderer.force = point.force;
    renderer.layers = point.layers;
    restore_set(renderer.layers, settings.layers, renderer.field);
    if (renderer.layers.set) {  // covers the field
        Tissues(settings.layers, renderer.layers, renderer.proxy, renderer.field);
    }
    if (!renderer.tool_proxy) return;
    drop_kept(*renderer.tool_proxy);
    resume_tool(*renderer.tool_proxy, point.tool);
}

}  // namespace palpate
