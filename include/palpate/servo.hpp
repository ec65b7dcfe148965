// Stage 14, servo: the real-time thread. It reads the device, advances the session and writes the
// force, usually a thousand times a second. Other threads observe snapshots and send commands.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "palpate/exchange.hpp"
#include "palpate/session.hpp"

namespace palpate {

/// How a component with a rate runs: in a thread of its own, in real time, or by calls of step()
/// from its owner, who passes the time. The latter is for tests and for sessions that run as fast
/// as possible: the same calls give the same results.
enum class Pace : std::uint8_t { own_thread, by_steps };

/// Content of a recording, in the order in which it took effect.
using SessionEvent = std::variant<SessionTick, Command>;

struct ServoSettings {
    double rate = 1000;  ///< [Hz] 250 to 8000
    /// Ask for SCHED_FIFO and for memory that is not swapped out. See Servo::privileges().
    bool real_time = true;
    int priority = 80;                ///< of SCHED_FIFO, 1 to 99. Threads of devices have 81
    std::size_t command_room = 1024;  ///< commands that may wait
    /// The queue that records ticks and commands. May be null. Must outlive the servo, or its
    /// stop_recording(). When the queue is full, events are lost (ServoReport::unrecorded). For
    /// samples with a recipe, only the recipe is recorded.
    Queue<SessionEvent>* recorder = nullptr;
    /// Clock for the ticks [ns, never backwards]. Null: the machine's monotonic clock. A clock of
    /// the caller also measures CPU time.
    Clock clock = nullptr;
};

/// The part of the worst tick that took most of its time.
enum class TickCause : std::uint8_t {
    none,
    machine,  ///< the system did not run the thread
    device,   ///< reading or writing it
    proxy,    ///< the proxy update
    other,    ///< commands, penetrability, force, snapshot, recording
};
const char* name_of(TickCause cause);

/// The failure of a device that ended the session. Its force is zero from then on (Device::stop()).
enum class DeviceFailure : std::uint8_t {
    none,
    threw,  ///< read() or write() threw an exception
    hung,   ///< read() or write() did not return within 10 ms, though its thread could run
};
/// In words. Empty for none.
const char* name_of(DeviceFailure failure);

/// The tick that took longest, lateness included.
struct WorstTick {
    std::int64_t tick = -1;
    std::int64_t lateness_ns = 0;  ///< wake-up after its due time
    std::int64_t work_ns = 0;      ///< from waking to the end, by the wall clock
    std::int64_t compute_ns = 0;   ///< the same by the thread's CPU clock
    TickCause cause = TickCause::none;
};

/// Counts and times of the loop. Lateness is caused by the system, compute time by this program.
struct ServoReport {
    std::int64_t ticks = 0;
    std::int64_t missed = 0;      ///< deadlines: ticks that did not run when they were due
    std::int64_t overruns = 0;    ///< ticks that took too long, so that their force was dropped
    std::int64_t unrecorded = 0;  ///< events that were lost because the recorder was full
    LatencySummary period, lateness, work, compute;  ///< [ns]. Compute is CPU time
    WorstTick worst;
};

/// The newest tick, for observers. Plain values: no observer has access to the session.
struct Snapshot {
    SessionTick session;
    std::int64_t number = 0;     ///< of the tick, from 0
    std::int64_t missed = 0;     ///< deadlines so far
    double speed = 0;            ///< at which a sequence is played
    double stiffness = 0;        ///< [N/mm] in use
    Vec3 normal = Vec3::Zero();  ///< of the constraint plane at the SCP, out of the solid, physical
    LatticePoint scp;            ///< the SCP and its tetrahedron, of the lattice of `interpolation`
    /// Contacts of the tool at the proxy's pose. Those with pressure touch. None for a point.
    std::array<ToolContact, most_tool_contacts> contacts{};
    int contact_count = 0;
    Interpolation interpolation = Interpolation::linear;
    bool penetrability_on = false;
    bool forces_on = true;
};

/// The state of a session after a tick, for observers. Neither throws nor allocates.
Snapshot snapshot_of(const Session& session, const SessionTick& tick, std::int64_t number,
                     std::int64_t missed) noexcept;

class WatchedDevice;

/// A session that runs on a thread of its own. Not copied or moved, because threads refer to it.
/// The threads of start() only wait and call step() and watch(). Without start(), a caller with its
/// own loop calls them, with times of its own clock.
///
/// If the device throws or hangs, the session ends (DeviceFailure): a second thread, the watchdog,
/// calls Device::stop() within 20 ms after the beginning of a call that hangs. This tick is not
/// recorded, and the device is not called any more. The last snapshot then shows a fault and no
/// force.
class Servo {
  public:
    /// Takes over the session. The device must outlive the servo. Nothing runs yet. The session
    /// uses the smaller of its settings and the limits that the device declares (keep_within()). If
    /// that changes the settings, a recording begins with the command that makes the change. Throws
    /// std::invalid_argument for settings that cannot run.
    Servo(Session session, Device& device, const ServoSettings& settings = {});
    /// stop(), also while other threads are in stop(). Waits for a device call that hangs.
    ~Servo();
    Servo(const Servo&) = delete;
    Servo& operator=(const Servo&) = delete;

    /// Starts the thread. May be called once, and not after step(). Throws std::system_error if the
    /// system cannot create a thread.
    void start();
    /// One tick, now, on one thread. The first one is at time 0 of the session. False when the
    /// session has ended, because stop() was called or the device has failed. Zero force was then
    /// written.
    bool step() noexcept;
    /// The same at a time of the caller [ns, never backwards], without a clock: no durations are
    /// measured.
    bool step(std::int64_t now) noexcept;
    /// When the next tick is due [ns, of the settings' clock]. The thread of step().
    std::int64_t due() const noexcept { return schedule_.due; }
    /// [ns] of its clock when the session's time was 0. From the end of start() on, any thread.
    std::int64_t begun() const noexcept { return schedule_.zero; }
    /// One check of the watchdog, to be called every 5 ms by one thread. A call to the device that
    /// three successive checks find unfinished counts as hung. `cpu`: all CPU time of the thread of
    /// step() [ns]. `could_run`: that thread only waits for a processor. Then only its CPU time
    /// counts.
    void watch(std::int64_t cpu, bool could_run) noexcept;
    /// Writes zero force and ends the thread. Returns when it has ended. If a device call hangs, it
    /// returns when the force has been set to zero. The thread then ends when that call returns,
    /// and accesses only the servo. Any thread, any number of times. From the servo thread (a
    /// device's read() or write()) it only requests the end. Without start(): on the thread of
    /// step(), or on others while that thread continues to call step().
    void stop() noexcept;

    /// Begins to record while the session runs, after the commands sent so far. The force
    /// continues. The recording begins with the limits, force settings and transform in use and
    /// with command::Resume, so that a session with the same settings and samples continues from
    /// here. False if the queue of commands is full. After the end of the session nothing is
    /// recorded. No recording may be running. Any thread but that of step(). Throws std::bad_alloc.
    bool record(Queue<SessionEvent>& recorder);
    /// Nothing is recorded any more when this returns. The session continues. Any thread but that
    /// of step().
    void stop_recording() noexcept;

    /// Checks a command and puts it in the queue. False if the queue is full. Throws
    /// std::invalid_argument as check(Command) does, and for limits that lower nothing. Any thread;
    /// never waits for the servo thread. A session that has ended accepts every command, so that a
    /// sender to several sessions need not wait. Except for samples, these take effect in session()
    /// as far as the queue has room. Keeps samples alive until the servo uses others, so that its
    /// thread never frees them.
    bool send(const Command& command);
    /// The number of the tick in which all commands sent so far have had their effect, at the
    /// latest: a tick executes at most 16. Any thread, never waits.
    std::int64_t sure_tick() const noexcept;
    /// The newest tick. Nothing before the first. Any thread, never waits.
    std::optional<Snapshot> snapshot() const noexcept { return snapshot_.get(); }
    ServoReport report() const noexcept;
    /// Commands that were sent and not yet executed. Any thread, never waits.
    std::int64_t waiting() const noexcept;
    /// Other than none: the session has ended. Any thread, never waits.
    DeviceFailure device_failure() const noexcept;
    /// There are no more ticks: stop() was called, or the device has failed. Any thread.
    bool has_ended() const noexcept;
    /// A tick or the thread may still use session and device, also after stop() while a call of the
    /// device hangs. Any thread.
    bool is_running() const noexcept;
    /// The session after its last tick and after all commands that no tick has executed, for
    /// example to continue it in another servo. One thread. Throws std::logic_error while
    /// is_running().
    const Session& session();

    /// A sentence for each privilege: granted, or not granted and what to set. After start().
    const std::vector<std::string>& privileges() const { return privileges_; }
    /// How late the thread was woken in each tick [ns]. It continues to count while the thread
    /// runs.
    const LatencyHistogram& lateness() const { return lateness_; }
    /// The settings of the session at the start, within the device's limits.
    const RendererSettings& settings() const { return start_; }

  private:
    /// When ticks are due [ns].
    struct Schedule {
        std::int64_t period = 0, zero = 0, due = 0;  // zero: of the session's time
        std::int64_t last_start = 0;
        WorstTick worst = {};
    };
    struct Stamps;
    struct TickClock;
    enum class State : std::uint8_t { idle, running, ended };

    void run() noexcept;
    void begin(std::int64_t first_tick) noexcept;
    bool step(const TickClock& clock) noexcept;
    void end(std::int64_t now) noexcept;
    void tick(const TickClock& clock) noexcept;
    void obey() noexcept;
    void keep_device_limits(const DeviceLimits& limits) noexcept;
    void count(std::int64_t number, const Stamps& stamps, std::int64_t end) noexcept;
    void record(const SessionEvent& event) noexcept;
    void begin_recording(const command::Resume& from) noexcept;
    void show_failure() noexcept;
    void publish(std::int64_t number, const SessionTick& tick) noexcept;
    void hold(const std::shared_ptr<const void>& sent);
    bool take(const CheckedCommand& checked);
    bool push(const CheckedCommand& checked);
    bool lower(const DeviceLimits& limits, const CheckedCommand& checked);

    // These begin on cache lines of their own. Placed first, they waste no space.
    Queue<CheckedCommand> commands_;
    Newest<Snapshot> snapshot_;
    Newest<WorstTick> worst_;
    Session session_;
    const std::unique_ptr<WatchedDevice> device_;
    const ServoSettings settings_;
    const Clock now_, cpu_now_;
    Schedule schedule_;     // the servo thread's
    bool in_step_ = false;  // the servo thread's
    RendererSettings start_;
    const FieldKind field_;
    std::vector<std::string> privileges_;
    std::thread thread_;
    std::atomic<std::thread::id> thread_id_;
    std::atomic<State> state_{State::idle};
    std::atomic<bool> ready_{false}, stopping_{false};
    std::atomic<int> stops_{0};  // calls of stop() under way
    std::atomic<Queue<SessionEvent>*> recorder_;
    std::atomic<bool> in_recorder_{false};  // the servo thread uses it at this moment
    /// The recording that waits for the servo thread: filled in there, then its recorder is used.
    std::shared_ptr<SessionPoint> next_point_;
    Queue<SessionEvent>* next_recorder_ = nullptr;
    std::atomic<const SessionPoint*> awaited_{nullptr};

    std::mutex sent_mutex_;  // between threads that send. The servo thread never takes it
    std::vector<std::shared_ptr<const void>> held_;  // each object once
    LatencyHistogram period_, lateness_, work_, compute_;
    std::atomic<std::int64_t> ticks_{0}, missed_{0}, overruns_{0}, unrecorded_{0};
    std::atomic<std::int64_t> sent_{0}, obeyed_{0};  // commands
    DeviceLimits limits_;                            // as sent, under sent_mutex_
};

}  // namespace palpate
