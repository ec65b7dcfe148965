// Stage 13, session: one tick of a live session, which is everything between reading a device and
// writing to it. A session is a value without clock or thread, so a recording of its input gives
// the same ticks again.
#pragma once

#include <variant>

#include "palpate/device.hpp"
#include "palpate/edit.hpp"
#include "palpate/names.hpp"
#include "palpate/renderer.hpp"

namespace palpate {

struct SessionSettings {
    /// Bits of the device's buttons. While any of them is held (the clutch), the volume moves with
    /// the hand and there is no force.
    std::uint32_t clutch_buttons = 0;
    /// There is force only while one of these is held (a dead-man switch); 0: no such switch.
    std::uint32_t deadman_buttons = 0;
    /// [device mm/s] Fastest plausible motion of a hand. A position that it could not have reached
    /// since the last good one counts as broken input until it could have.
    double fastest_hand = 1e4;
    /// [s] A tick that takes longer gives no force, and the force starts again with the ramp.
    double overrun = 0.02;
};
template <>
inline constexpr auto settings_of<SessionSettings> = std::tuple{
    setting(&SessionSettings::clutch_buttons, "clutch_buttons", "",
            "Bits of the buttons that hold the volume to the hand"),
    setting(&SessionSettings::deadman_buttons, "deadman_buttons", "",
            "Bits of the buttons of which one must be held (0: none)"),
    setting(&SessionSettings::fastest_hand, "fastest_hand", "device mm/s",
            "Fastest plausible motion of a hand. A jump to a position that needs more counts as no "
            "reading")
        .titled("fastest hand")
        .as_option("--fastest-hand")
        .within(ranges::limit),
    setting(&SessionSettings::overrun, "overrun", "s", "A tick that takes longer gives no force")
        .as_option("--overrun")
        .within(ranges::limit)};

/// How samples were made, so that a replay of a recording can make them again.
struct EditOf {
    std::uint64_t version = 0;  ///< of the samples that were edited
    Edit edit;
};
/// Frames of the sequence that the session plays.
struct FramesOf {
    std::vector<int> numbers;   ///< of the frames, from 0
    std::vector<double> times;  ///< [s] of each
    double period = 0;          ///< [s]
};
/// Bricks of a large grid that were loaded into memory or removed from it.
struct BricksOf {
    std::uint64_t version = 0;  ///< of the samples before
    struct Change {
        Index3 at;
        int level = 0;  ///< of detail, see Brick; -1: removed
    };
    std::vector<Change> bricks;
};
using Recipe = std::variant<EditOf, FramesOf, BricksOf>;

struct SessionPoint;

/// Commands change a running session; each is applied between two ticks.
namespace command {
struct Isovalue {
    double isovalue;  ///< [data units]
};
struct Freeze {
    bool on;  ///< hand and proxy stand still, there is no force
};
struct Clutch {
    bool on;  ///< as if a clutch button was held
};
struct Forces {
    bool on;
};
/// Another version of the samples on the same grid, from the next tick on: after an edit, or the
/// next frames. The sequence's time stays, clamped to the frames.
struct Samples {
    std::shared_ptr<const palpate::Samples> samples;  ///< not null
    std::uint64_t version = 0;  ///< any number; observers see it while these samples are in use
    /// For recordings. Null if this version was sent before, is that of the start (0), or cannot be
    /// made again by a replay.
    std::shared_ptr<const Recipe> recipe = nullptr;
};
/// Goes to a time of a sequence [s]; the speed stays.
struct Moment {
    double time;
};
/// Speed at which a sequence is played: seconds of it per second, backwards if negative, 0: paused.
struct Speed {
    double speed;
};
/// Layers from the next tick on; null: none, and the isovalue applies again. All surfaces that gave
/// way close: the SCP is in the tissue at its position.
struct UseLayers {
    std::shared_ptr<const Layers> layers;
    /// These are the present surfaces with other levels or properties: surfaces that gave way stay
    /// open. This has an effect only if there are as many surfaces, and the labels are the same.
    bool same_surfaces = false;
};
/// Another tool from the next tick on; null: a point. The force starts again. While a tool is used,
/// layers, penetrability, magnet and texture have no effect.
struct UseTool {
    std::shared_ptr<const Tool> tool;
};
/// Frees the proxy, for example from a closed shell: it starts at the hand with the next tick. All
/// punctured surfaces close. The force starts again.
struct Lift {};
/// Scales the volume about the SCP, which changes neither the proxy nor the force.
struct Scale {
    double scale;  ///< physical mm per device mm, > 0
};
/// Continues from a point of another session with the same settings and samples, for a recording
/// that begins while a session runs. Servo::record() makes it.
struct Resume {
    std::shared_ptr<const SessionPoint> point;  ///< not null
};
}  // namespace command
/// ForceSettings are lowered until they are stable within the session's device limits (stable()). A
/// new DeviceTransform may move the HIP, so the force starts again from zero. The session keeps the
/// smaller of DeviceLimits and its own limits, permanently (keep_within()).
using Command = std::variant<command::Isovalue, command::Freeze, command::Clutch, command::Forces,
                             command::Scale, command::Samples, command::Moment, command::Speed,
                             command::UseLayers, command::UseTool, command::Resume, ForceSettings,
                             Friction, Penetrability, DeviceTransform, DeviceLimits, command::Lift>;

/// One callable of several, for std::visit over a Command: an alternative that is left out does not
/// compile.
template <class... Each>
struct Overloaded : Each... {
    using Each::operator()...;
};
template <class... Each>
Overloaded(Each...) -> Overloaded<Each...>;

/// The state of the hand after the ticks so far.
struct HandPast {
    bool begun = false;                   ///< there was a tick
    bool seen = false;                    ///< a position was accepted
    bool holding = false;                 ///< the clutch was closed in the last tick
    double last_tick = 0;                 ///< [s] time of the last one
    double seen_at = 0;                   ///< [s] time of the last accepted position
    Vec3 hand = Vec3::Zero();             ///< [device mm] the last accepted position
    Vec3 frozen_hand = Vec3::Zero();      ///< [device mm] position of the hand when it was frozen
    Mat3 tool = Mat3::Identity();         ///< the last good orientation, tool axes to device axes
    Mat3 frozen_tool = Mat3::Identity();  ///< when it was frozen
    Vec3 held_hip = Vec3::Zero();         ///< [mm, physical] at the moment it closed
    Mat3 held_tool = Mat3::Identity();    ///< tool axes to physical axes at that moment
};

/// The state between two ticks. A value: a copy that gets the same readings and commands gives the
/// same ticks, bit for bit.
struct Session {
    Renderer renderer;
    SessionSettings settings;
    double speed = 0;           ///< at which a sequence is played
    std::uint64_t version = 0;  ///< of the samples, as it was sent with them
    bool frozen = false;        ///< from the first accepted position on
    bool clutched = false;      ///< by command
    HandPast past = {};
};

/// The state of a session between two ticks that follows from neither its settings nor its samples.
struct SessionPoint {
    double moment = 0;  ///< [s] of the sequence
    double speed = 0;
    bool frozen = false;
    bool clutched = false;
    bool starts_inside = false;
    HandPast past = {};
    Proxy proxy;
    std::optional<double> isovalue_without_layers;
    std::optional<Vec3> drawn_to;
    ForceState force;
    LayerState layers;
    ToolState tool;
};
/// Writes the state of a session to `point`. The proxy first drops results that only save time.
/// Neither throws nor allocates.
void checkpoint(Session& session, SessionPoint& point) noexcept;
/// Continues where another session was left, with the same device and on the same grid. The field
/// may be another one: where the solid side stays, the proxy stays on its side of the surface that
/// it touched. Time begins anew, motors are as warm as they were, and all surfaces of layers are
/// closed. Call it before the first tick.
void take_up(Session& session, const Session& before);

/// The result of a live tick.
struct SessionTick {
    Tick tick;  ///< time, proxy, force as written to the device
    DeviceReading device;
    DeviceTransform transform;  ///< in use in this tick
    bool frozen = false;
    bool clutched = false;
    double moment = 0;          ///< [s] of the sequence
    std::uint64_t version = 0;  ///< of the samples
};

/// Throws std::invalid_argument for settings out of range.
void check(const SessionSettings& settings);
/// Throws std::invalid_argument, with the reason, for a command that a session with these settings
/// and such a field cannot carry out.
void check(const Command& command, const RendererSettings& settings, const FieldKind& field);

/// A command that passed check(). A session executes only such commands, so no number that is not
/// finite or out of range can enter between two ticks.
class CheckedCommand {
  public:
    /// Throws as check(), except for settings that have no effect with a tool: it is not known here
    /// whether there is a tool when the command is executed.
    CheckedCommand(Command command, const RendererSettings& settings, const FieldKind& field);
    /// Switches the forces off, which is valid in every session.
    CheckedCommand() = default;

    const Command& command() const { return command_; }

  private:
    Command command_ = command::Forces{false};
};

/// Executes a command. Never throws or allocates. Frees the samples that it replaces unless they
/// are held elsewhere (Servo::send() holds them). A tool needs make_room_for_tools() before.
void apply(Session& session,  // NOLINT(bugprone-exception-escape)
           const CheckedCommand& command) noexcept;
/// The same with the check, and with memory allocated if the command needs some. Throws as check();
/// then nothing has changed.
void apply(Session& session, const Command& command);

/// Keeps the smaller of the session's device limits and these, and lowers the force settings as far
/// as needed (stable()). True if that changed anything.
bool keep_within(Session& session, const DeviceLimits& limits) noexcept;

/// One tick at a time [s] after the last. Never throws or allocates. There is no force for input
/// that is not ready, older than the force settings' `stale_after` (or with an age below 0 or not
/// finite), not finite or not plausible. The caller has to apply DeviceReading::limits, as a
/// command. If a clock is given, it measures the proxy update (Tick::update_ns).
SessionTick advance(Session& session, double time, const DeviceReading& reading,
                    Clock clock = nullptr) noexcept;

/// Sets the force of a tick that came too late to zero, and starts the force again.
void drop_force(Session& session, SessionTick& tick) noexcept;

/// Renders a recorded tick again: advance() with its time and reading, and drop_force() if its
/// force was set to zero. The result has the same bits if the session is in the same state.
SessionTick repeat(Session& session, const SessionTick& recorded) noexcept;

}  // namespace palpate
