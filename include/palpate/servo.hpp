// Stage 15, servo: the real-time thread. It reads the device, advances the session and writes the
// force, a thousand times a second; everyone else observes snapshots and sends commands.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "palpate/exchange.hpp"
#include "palpate/latency.hpp"
#include "palpate/session.hpp"

namespace palpate {

/// What goes into a recording, in the order in which it took effect.
using SessionEvent = std::variant<SessionTick, Command>;

struct ServoSettings {
    double rate = 1000;  ///< [Hz] 250 to 8000
    /// Ask for SCHED_FIFO and for memory that is not swapped out. Servo::privileges() tells what
    /// was granted.
    bool real_time = true;
    int priority = 80;                ///< of SCHED_FIFO, 1 to 99
    std::size_t command_room = 1024;  ///< commands that may wait
    /// Where ticks and commands are recorded, if anywhere; must outlive the servo. One that is full
    /// loses events (ServoReport::unrecorded).
    Queue<SessionEvent>* recorder = nullptr;
};

/// Where most of the worst tick went.
enum class TickCause : std::uint8_t {
    none,
    machine,  ///< the machine did not let the thread run: not our doing
    device,   ///< reading or writing it
    proxy,    ///< the proxy update
    other,    ///< commands, penetrability, force, snapshot, recording
};
const char* name_of(TickCause cause);

/// The tick that took longest, lateness included.
struct WorstTick {
    std::int64_t tick = -1;
    std::int64_t lateness_ns = 0;  ///< woken after its time
    std::int64_t work_ns = 0;      ///< from waking to the end, by the wall clock
    std::int64_t compute_ns = 0;   ///< the same by the thread's CPU clock: our share
    TickCause cause = TickCause::none;
};

/// How the loop does. Lateness is the machine's doing, compute time ours; both make the period.
struct ServoReport {
    std::int64_t ticks = 0;
    std::int64_t missed = 0;      ///< deadlines: ticks that did not happen at their time
    std::int64_t overruns = 0;    ///< ticks whose force came too late and was taken back
    std::int64_t unrecorded = 0;  ///< events that found the recorder full
    LatencySummary period, lateness, work, compute;  ///< [ns]; compute is CPU time
    WorstTick worst;
};

/// The newest tick, for who observes. Plain values: nobody outside sees into the session.
struct Snapshot {
    std::int64_t number = 0;  ///< of the tick, from 0
    SessionTick session;
    LatticePoint scp;            ///< the SCP, with the tetrahedron that it is in
    Vec3 normal = Vec3::Zero();  ///< of the constraint plane at the SCP, out of the solid, physical
    double stiffness = 0;        ///< [N/mm] in use
    bool penetrability_on = false;
    bool forces_on = true;
    double speed = 0;         ///< at which a sequence is played
    std::int64_t missed = 0;  ///< deadlines so far
};

/// What is seen of a session after a tick. Neither throws nor allocates.
Snapshot snapshot_of(const Session& session, const SessionTick& tick, std::int64_t number,
                     std::int64_t missed) noexcept;

/// A session running on its own thread. Neither copied nor moved: threads hold on to it.
class Servo {
  public:
    /// Takes the session over; the device must outlive the servo. Nothing runs yet. The session
    /// keeps the smaller of its settings and the limits that the device declares (keep_within());
    /// where that changes it, a recording begins with the command that does. Throws
    /// std::invalid_argument for settings that cannot be run.
    Servo(Session session, Device& device, const ServoSettings& settings = {});
    /// stop().
    ~Servo();
    Servo(const Servo&) = delete;
    Servo& operator=(const Servo&) = delete;

    /// Starts the thread, once. Throws std::system_error if the system gives none.
    void start();
    /// Writes zero force and ends the thread; returns when it has ended.
    void stop() noexcept;

    /// Checks a command and puts it in the queue; false if the queue is full. Throws
    /// std::invalid_argument as check(Command) does. Any thread; the servo thread is never waited
    /// for. Samples that were sent are held until the servo has gone on to others, so that it is
    /// never its thread that frees them.
    bool send(const Command& command);
    /// The newest tick; nothing before the first. Any thread, never waits.
    std::optional<Snapshot> snapshot() const noexcept { return snapshot_.get(); }
    ServoReport report() const noexcept;
    /// The session as its last tick left it, to go on with in another servo. Throws
    /// std::logic_error while the thread runs.
    const Session& session() const;

    /// What the system granted and what not, a sentence each, with what to set. After start().
    const std::vector<std::string>& privileges() const { return privileges_; }
    /// The settings of the session at the start, within the device's limits.
    const RendererSettings& settings() const { return start_; }

  private:
    struct Clock;
    struct Stamps;

    void run() noexcept;
    void tick(Clock& clock) noexcept;
    void obey() noexcept;
    void keep_device_limits(const DeviceLimits& limits) noexcept;
    void count(Clock& clock, std::int64_t number, const Stamps& stamps) noexcept;
    void record(const SessionEvent& event) noexcept;
    void publish(std::int64_t number, const SessionTick& tick) noexcept;
    void hold(const std::shared_ptr<const void>& sent);

    Session session_;
    Device& device_;
    const ServoSettings settings_;
    RendererSettings start_;
    const Solid solid_;
    const Geometry geometry_;
    std::vector<std::string> privileges_;
    std::jthread thread_;
    std::atomic<bool> ready_{false}, stopping_{false};

    std::mutex held_mutex_;  // among those who send; the servo thread never comes near
    std::vector<std::shared_ptr<const void>> held_;  // none twice
    Queue<Command> commands_;
    Newest<Snapshot> snapshot_;
    Newest<WorstTick> worst_;
    LatencyHistogram period_, lateness_, work_, compute_;
    std::atomic<std::int64_t> ticks_{0}, missed_{0}, overruns_{0}, unrecorded_{0};
};

}  // namespace palpate
