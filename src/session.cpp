// Session: which input counts, what clutch and freeze do, and how commands are carried out.
#include "palpate/session.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "layers/needle.hpp"
#include "session/session_point.hpp"

namespace palpate {
namespace {

/// Whether a hand can have moved here since the last good position.
bool plausible(const Session& session, double time, const Vec3& position) {
    // After an infinite time no later one could count.
    if (!std::isfinite(time) || !position.allFinite()) return false;
    if (!(position.cwiseAbs().maxCoeff() <= farthest_hand)) return false;
    if (!session.past.seen) return true;
    const double distance = (position - session.past.hand).norm();
    return distance <= session.settings.fastest_hand * (time - session.past.seen_at);
}

/// The rotation without the rounding errors of orientations, which add up each time the clutch
/// closes.
Mat3 orthonormal(const Mat3& m) {
    Mat3 r;
    r.col(0) = m.col(0).normalized();
    r.col(1) = (m.col(1) - r.col(0) * r.col(0).dot(m.col(1))).normalized();
    r.col(2) = r.col(0).cross(r.col(1));
    return r;
}

/// Moves and turns the volume so that HIP and tool stay where they were in it.
void hold(Session& session, const Mat3& tool, const Vec3& position) {
    DeviceTransform& transform = session.renderer.settings.transform;
    if (!session.past.holding) {
        session.past.held_hip = physical_from_device(transform, position);
        session.past.held_tool = transform.rotation * tool;
    }
    transform.rotation = orthonormal(session.past.held_tool * tool.transpose());
    transform.translation =
        session.past.held_hip - transform.scale * (transform.rotation * position);
}

/// Scales about the SCP: its device position stays, and with it the pull in device mm.
void scale_about_scp(Renderer& renderer, double scale) {
    DeviceTransform& transform = renderer.settings.transform;
    const bool tool = renderer.settings.tool != nullptr;
    if (tool ? renderer.tool_proxy->placed : renderer.proxy.placed) {
        const Vec3& scp = tool ? renderer.tool_proxy->pose.position : renderer.proxy.scp_physical;
        const double factor = scale / transform.scale;
        transform.translation = scp + factor * (transform.translation - scp);
        // The hand is farther from the SCP in the volume, and so is what holds a needle's shaft.
        LayerState& layers = renderer.layers;
        NeedleState& needle = layers.needle;
        const double tip = along_line(needle, scp);
        needle.hand = tip + factor * (needle.hand - tip);
        needle.anchor = tip + factor * (needle.anchor - tip);
        layers.hip = scp + factor * (layers.hip - scp);
    }
    transform.scale = scale;
}

void use_layers(Renderer& renderer, const command::UseLayers& to) noexcept {
    RendererSettings& settings = renderer.settings;
    const bool keeps = to.same_surfaces && renderer.layers.set == settings.layers &&
                       keep_for(renderer.layers, to.layers);
    // Before the set goes, so that nothing of it is freed here.
    if (!keeps) forget_layers(renderer.layers, renderer.proxy, renderer.field);
    settings.layers = to.layers;
}

/// Changes the samples or their time, in every field that is made of them.
template <class Change>
void change_data(Renderer& renderer, Change&& change) noexcept {
    std::optional<Field>& covered = renderer.layers.covered;
    // Labels stand still.
    const bool are_felt = !covered || covered->shared_samples() == renderer.field.shared_samples();
    if (are_felt) field_will_change(renderer.proxy, felt_field(renderer));
    change(renderer.field);
    if (covered && are_felt) change(*covered);
}

/// A sequence that passes a frame in fewer ticks jumps. Otherwise its surfaces move, and push the
/// hand as they do.
constexpr double fewest_ticks_of_frame = 10;

/// The place of a moment among the frames.
double frame_at(const Moment& moment) {
    return static_cast<double>(moment.from) + moment.weight;
}

/// How many frames lie between two places. After the last frame of a loop, the first one follows.
double frames_between(const Samples& samples, double one, double other) {
    const double passed = std::abs(one - other);
    if (!(samples.period() > 0)) return passed;
    return std::min(passed, static_cast<double>(samples.frames().size()) - passed);
}

/// Moves a playing sequence on with the time of the ticks, within its frames.
void play(Session& session, double time) {
    if (!std::isfinite(time)) return;
    Field& field = session.renderer.field;
    const double dt = session.past.begun ? time - session.past.last_tick : 0;
    if (session.speed != 0 && dt > 0) {
        const double to = field.samples().within(field.time() + session.speed * dt);
        const double before = frame_at(field.moment());
        change_data(session.renderer, [to](Field& changed) { changed.set_time(to); });
        const double passed = frames_between(field.samples(), before, frame_at(field.moment()));
        session.renderer.force.changed |= passed * fewest_ticks_of_frame > 1;
    }
    session.past.begun = true;
    session.past.last_tick = time;
}

}  // namespace

void check(const SessionSettings& s) {
    check_ranges(s);
}

/// The settings that a command leaves. Checks what is the command's alone.
static RendererSettings changed_by(const Command& command, const RendererSettings& settings,
                                   const FieldKind& field) {
    const Solid solid = field.solid;
    RendererSettings changed = settings;
    const Overloaded check_one{
        [&](const command::Isovalue& to) { check_isovalue(to.isovalue, solid); },
        [](const command::Freeze&) {},
        [](const command::Clutch&) {},
        [](const command::Forces&) {},
        [&](const command::Scale& to) { changed.transform.scale = to.scale; },
        [&](const command::Samples& to) {
            if (!to.samples) throw std::invalid_argument("no samples are given");
            if (!(to.samples->geometry() == field.geometry)) {
                throw std::invalid_argument(
                    "the samples do not lie on the grid of the present ones");
            }
        },
        [](const command::Moment& to) {
            if (!std::isfinite(to.time)) throw std::invalid_argument("the time is not finite");
        },
        [](const command::Speed& to) {
            if (!(std::abs(to.speed) <= 1000)) {
                throw std::invalid_argument("a sequence is played at most 1000 times as fast");
            }
        },
        [&](const command::UseLayers& to) {
            if (to.layers) check(*to.layers, solid);
            changed.layers = to.layers;
        },
        [&](const command::UseTool& to) {
            check_tool(to.tool.get(), changed.method, field);
            changed.tool = to.tool;
        },
        [&](const command::Resume& to) {
            if (!to.point) throw std::invalid_argument("the point at which to continue is missing");
            check(*to.point, settings, field);
        },
        [&](const ForceSettings& to) { changed.force = to; },
        [&](const Friction& to) { changed.proxy.friction = to; },
        [&](const Penetrability& to) {
            check(to, solid);
            changed.penetrability = to;
        },
        [&](const DeviceTransform& to) { changed.transform = to; },
        [](const DeviceLimits& to) { check(to); },
        [](const command::Lift&) {},
    };
    std::visit(check_one, command);
    return changed;
}

void check(const Command& command, const RendererSettings& settings, const FieldKind& field) {
    check(changed_by(command, settings, field));
}

CheckedCommand::CheckedCommand(Command command, const RendererSettings& settings,
                               const FieldKind& field)
    : command_(std::move(command)) {
    RendererSettings changed = changed_by(command_, settings, field);
    changed.tool.reset();
    check(changed);
}

void apply(Session& session, const Command& command) {
    Renderer& renderer = session.renderer;
    check(command, renderer.settings, kind_of(renderer.field));
    const CheckedCommand checked(command, renderer.settings, kind_of(renderer.field));
    if (std::holds_alternative<command::UseTool>(command)) make_room_for_tools(renderer);
    apply(session, checked);
}

// std::visit throws only for a variant without a value, and check() has visited this one.
void apply(Session& session,  // NOLINT(bugprone-exception-escape)
           const CheckedCommand& checked) noexcept {
    Renderer& renderer = session.renderer;
    RendererSettings& settings = renderer.settings;
    Field& field = renderer.field;
    if (!std::holds_alternative<DeviceLimits>(checked.command())) renderer.force.changed = true;
    const Overloaded apply_one{
        [&](const command::Isovalue& to) { use_isovalue(renderer, to.isovalue); },
        [&](const command::Freeze& to) {
            if (to.on && !session.frozen) {
                session.past.frozen_hand = session.past.hand;
                session.past.frozen_tool = session.past.tool;
            }
            session.frozen = to.on;
        },
        [&](const command::Clutch& to) { session.clutched = to.on; },
        [&](const command::Forces& to) { settings.forces_on = to.on; },
        [&](const command::Scale& to) {
            scale_about_scp(renderer, to.scale);
            session.past.holding = false;  // what was held was held at the other scale
        },
        [&](const command::Samples& to) {
            change_data(renderer, [&](Field& changed) {
                changed.use(to.samples);
                changed.set_time(to.samples->within(changed.time()));
            });
            session.version = to.version;
        },
        [&](const command::Moment& to) {
            const double time = field.samples().within(to.time);
            change_data(renderer, [time](Field& changed) { changed.set_time(time); });
        },
        [&](const command::Speed& to) { session.speed = to.speed; },
        [&](const command::UseLayers& to) { use_layers(renderer, to); },
        [&](const command::UseTool& to) { use_tool(renderer, to.tool, session.past.tool); },
        [&](const command::Resume& to) { resume(session, *to.point); },
        [&](const ForceSettings& to) { settings.force = stable(to, settings.device); },
        [&](const Friction& to) { settings.proxy.friction = to; },
        [&](const Penetrability& to) { settings.penetrability = to; },
        [&](const DeviceTransform& to) {
            settings.transform = to;
            session.past.holding = false;
            renderer.force.waiting = true;
        },
        [&](const DeviceLimits& to) { keep_within(session, to); },
        [&](const command::Lift&) { lift(renderer); },
    };
    std::visit(apply_one, checked.command());
}

bool keep_within(Session& session, const DeviceLimits& limits) noexcept {
    RendererSettings& settings = session.renderer.settings;
    const DeviceLimits device = smaller(settings.device, limits);
    const ForceSettings force = stable(settings.force, device);
    const bool changed = !(device == settings.device && force == settings.force);
    session.renderer.force.changed |= changed;
    settings.device = device;
    settings.force = force;
    return changed;
}

SessionTick advance(Session& session, double time, const DeviceReading& reading,
                    Clock clock) noexcept {
    const SessionSettings& settings = session.settings;
    // Only such an age shows that the reading was measured lately.
    const bool fresh = std::isfinite(reading.age) && reading.age >= 0 &&
                       reading.age <= session.renderer.settings.force.stale_after;
    TickInput state;
    state.time = time;
    state.valid = reading.status == DeviceStatus::ready && fresh &&
                  plausible(session, time, reading.position);
    state.armed = settings.deadman_buttons == 0 || (reading.buttons & settings.deadman_buttons);
    const bool clutched = session.clutched || (reading.buttons & settings.clutch_buttons) != 0;
    state.released = session.frozen || clutched;

    // An orientation that is not a rotation is ignored: the last one stays.
    const bool has_tool = is_rotation(reading.orientation, orientation_tolerance);
    const bool is_exact = is_rotation(reading.orientation);
    const Mat3 tool = is_exact ? reading.orientation : orthonormal(reading.orientation);
    if (state.valid) {
        if (has_tool) session.past.tool = tool;
        if (!session.past.seen) {
            session.past.frozen_hand = reading.position;
            session.past.frozen_tool = session.past.tool;
        }
        session.past.seen = true;
        session.past.seen_at = time;
        session.past.hand = reading.position;
    }
    const bool hangs = clutched && !session.frozen;
    if (hangs && state.valid) hold(session, session.past.tool, reading.position);
    session.past.holding = hangs && (state.valid || session.past.holding);
    state.position = session.frozen ? session.past.frozen_hand : reading.position;
    state.orientation = session.frozen ? session.past.frozen_tool : session.past.tool;
    // Devices without an orientation give the identity.
    if (!reading.orientation.isIdentity(0) && has_tool) state.pointing = -tool.col(2);
    play(session, time);
    SessionTick result;
    result.tick = render(session.renderer, state, {}, clock);
    result.device = reading;
    result.transform = session.renderer.settings.transform;
    result.frozen = session.frozen;
    result.clutched = clutched;
    result.moment = session.renderer.field.time();
    result.version = session.version;
    return result;
}

void drop_force(Session& session, SessionTick& tick) noexcept {
    restart(session.renderer.force);
    tick.tick.force.setZero();
    tick.tick.torque.setZero();
    tick.tick.force_flags |= force_overrun;
}

SessionTick repeat(Session& session, const SessionTick& recorded) noexcept {
    SessionTick tick = advance(session, recorded.tick.time, recorded.device);
    if (recorded.tick.force_flags & force_overrun) drop_force(session, tick);
    return tick;
}

}  // namespace palpate
