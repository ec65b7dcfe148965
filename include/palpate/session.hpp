// Stage 14, session: a live tick. What the servo thread does between reading a device and writing
// to it, as a value without clock or thread, so that a recording gives the same ticks again.
#pragma once

#include <variant>

#include "palpate/device.hpp"
#include "palpate/edit.hpp"
#include "palpate/renderer.hpp"

namespace palpate {

struct SessionSettings {
    /// Bits of the device's buttons: while any of them is held, the volume hangs on the hand (the
    /// clutch), and forces are let go.
    std::uint32_t clutch_buttons = 0;
    /// While none of these is held there is no force (a dead-man switch); 0: no such switch.
    std::uint32_t deadman_buttons = 0;
    /// [device mm/s] No hand is faster: a position that it could not have reached since the last
    /// good one is broken input until it could have.
    double fastest_hand = 1e4;
    /// [s] A tick that takes longer gives no force, and the next ones start anew.
    double overrun = 0.02;
};

/// How samples came about, so that a recording of a session can make them again.
struct EditOf {
    std::uint64_t version = 0;  ///< of the samples that were edited
    Edit edit;
};
/// Frames of the sequence that the session plays.
struct FramesOf {
    std::vector<int> numbers;   ///< which ones, from 0
    std::vector<double> times;  ///< [s] of each
    double period = 0;          ///< [s]
};
using Recipe = std::variant<EditOf, FramesOf>;

/// Asks of a running session; each is applied between two ticks.
namespace command {
struct Isovalue {
    double isovalue;  ///< [data units]
};
struct Freeze {
    bool on;  ///< hand and proxy stand still for the session, forces are let go
};
struct Clutch {
    bool on;  ///< as a clutch button
};
struct Forces {
    bool on;
};
/// Other samples on the same grid, from the next tick on: after an edit, or the next frames. The
/// sequence's time stays, within the frames there are.
struct Samples {
    std::shared_ptr<const palpate::Samples> samples;  ///< not null
    std::uint64_t version = 0;  ///< any number that tells who observes which samples are felt
    /// For recordings. Null where this version was sent before, is that of the start (0), or
    /// cannot be made again.
    std::shared_ptr<const Recipe> recipe = nullptr;
};
/// Goes to a time of a sequence [s], and stays there or plays on as before.
struct Moment {
    double time;
};
/// How fast a sequence is played: seconds of it per second, backwards if negative; 0: it stands
/// still.
struct Speed {
    double speed;
};
/// Another scale about the SCP: neither the proxy nor the force changes with it.
struct Scale {
    double scale;  ///< physical mm per device mm, > 0
};
}  // namespace command
/// ForceSettings are lowered to what is stable within the session's device limits (stable()). A new
/// DeviceTransform may move the HIP: forces are let go and start anew. DeviceLimits are those of
/// the device: the session keeps the smaller of them and its own, for good.
using Command = std::variant<command::Isovalue, command::Freeze, command::Clutch, command::Forces,
                             command::Scale, command::Samples, command::Moment, command::Speed,
                             ForceSettings, Friction, Penetrability, DeviceTransform, DeviceLimits>;

/// One callable of several, for std::visit over a Command: an alternative that is left out does not
/// compile.
template <class... Each>
struct Overloaded : Each... {
    using Each::operator()...;
};
template <class... Each>
Overloaded(Each...) -> Overloaded<Each...>;

/// Everything between two ticks. A value: copied, and given the same readings and commands, both
/// go on alike, bit for bit.
struct Session {
    Renderer renderer;
    SessionSettings settings;
    bool frozen = false;        ///< from the first accepted position on
    bool clutched = false;      ///< by command
    double speed = 0;           ///< at which a sequence is played
    std::uint64_t version = 0;  ///< of the samples, as it was sent with them

    // What the last ticks left.
    bool begun = false;                 ///< there was a tick
    double last_tick = 0;               ///< [s] its time
    bool seen = false;                  ///< a position was accepted
    double seen_at = 0;                 ///< [s] when the last one was
    Vec3 hand = Vec3::Zero();           ///< [device mm] the last one
    Vec3 frozen_hand = Vec3::Zero();    ///< [device mm] where the hand was when it was frozen
    Mat3 tool = Mat3::Identity();       ///< the last orientation while the clutch was closed
    bool holding = false;               ///< the clutch was closed in the last tick
    Vec3 held_hip = Vec3::Zero();       ///< [mm, physical] at the moment it closed
    Mat3 held_tool = Mat3::Identity();  ///< tool axes to physical axes at that moment
};

/// What a live tick gave.
struct SessionTick {
    Tick tick;  ///< time, proxy, force as it goes to the device
    DeviceReading device;
    DeviceTransform transform;  ///< in use in this tick
    bool frozen = false;
    bool clutched = false;
    double moment = 0;          ///< [s] of the sequence
    std::uint64_t version = 0;  ///< of the samples
};

/// Throws std::invalid_argument for settings out of range.
void check(const SessionSettings& settings);
/// Throws std::invalid_argument, saying what is wrong, for a command that this session could not
/// carry out. `settings` are the session's; its rate and device limits count.
void check(const Command& command, const RendererSettings& settings, Solid solid);
/// Throws std::invalid_argument for samples that are null or do not lie on the session's grid.
void check(const command::Samples& samples, const Geometry& geometry);

/// Carries out a command that passed check(). Never throws or allocates; samples that it replaces
/// are freed here unless somebody else holds them (Servo::send() sees to that).
void apply(Session& session, const Command& command) noexcept;

/// Keeps the smaller of the session's device limits and these, and lowers the force settings as far
/// as needed (stable()). True if that changed anything.
bool keep_within(Session& session, const DeviceLimits& limits) noexcept;

/// One tick at a time [s] after the last. Never throws or allocates. No force for input that is not
/// ready, older than the force settings' `stale_after`, not finite or not plausible.
/// DeviceReading::limits are the caller's to apply, as a command. The proxy update is timed where a
/// clock is given (Tick::update_ns).
SessionTick advance(Session& session, double time, const DeviceReading& reading,
                    Clock clock = nullptr) noexcept;

/// Takes the force of a tick back because it came too late, and starts anew.
void let_go(Session& session, SessionTick& tick) noexcept;

/// The tick that a recorded one should be if the session was in the same state: advance() with its
/// time and reading, and let_go() where its force was taken back. The same bits, or something is
/// wrong.
SessionTick repeat(Session& session, const SessionTick& recorded) noexcept;

}  // namespace palpate
