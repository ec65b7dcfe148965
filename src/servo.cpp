// Servo: the loop, its clock and its counters. The running thread only computes, reads clocks and
// sleeps (tested in tests/core/quiet).
#include "palpate/servo.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "palpate/names.hpp"
#include "servo/clocks.hpp"
#include "servo/privileges.hpp"
#include "servo/watched_device.hpp"

namespace palpate {
namespace {

/// Most commands carried out between two ticks; others wait, so that many cannot stall the loop.
constexpr int commands_per_tick = 16;
/// From the start of the thread to its first tick [ns].
constexpr std::int64_t settle_ns = 1'000'000;
/// Interval at which start() and stop() check what the thread does.
constexpr auto poll = std::chrono::microseconds(100);

void add(std::atomic<std::int64_t>& counter, std::int64_t amount) {
    counter.store(counter.load(std::memory_order_relaxed) + amount, std::memory_order_relaxed);
}

}  // namespace

template <>
inline constexpr auto names_of<TickCause> = enum_names("cause", "none", "the machine", "the device",
                                                       "the proxy update", "the rest of the tick");
template <>
inline constexpr auto names_of<DeviceFailure> =
    enum_names("failure", "", "a call of its driver failed with an exception",
               "a call of its driver does not return");

const char* name_of(TickCause cause) {
    return enum_name(cause);
}

const char* name_of(DeviceFailure failure) {
    return enum_name(failure);
}

Snapshot snapshot_of(const Session& session, const SessionTick& tick, std::int64_t number,
                     std::int64_t missed) noexcept {
    const Renderer& renderer = session.renderer;
    Snapshot snapshot;
    snapshot.number = number;
    snapshot.session = tick;
    snapshot.interpolation = renderer.proxy.interpolation;
    snapshot.scp = renderer.proxy.scp;
    if (renderer.layers.covered) {  // to the lattice of the data
        snapshot.scp =
            locate(snapshot.interpolation,
                   index_from_physical(renderer.field.geometry(), renderer.proxy.scp_physical));
    }
    snapshot.normal = normal_at(renderer.proxy, felt_field(renderer));
    if (renderer.settings.tool) {
        snapshot.contacts = renderer.tool_proxy->contacts;
        snapshot.contact_count = renderer.tool_proxy->contact_count;
        snapshot.normal.setZero();
    }
    snapshot.stiffness = renderer.settings.force.stiffness;
    snapshot.penetrability_on = renderer.settings.penetrability.on;
    snapshot.speed = session.speed;
    snapshot.forces_on = renderer.settings.forces_on;
    snapshot.missed = missed;
    return snapshot;
}

/// Times of one tick: its start, and how long its parts took [ns].
struct Servo::Stamps {
    std::int64_t start;
    std::int64_t compute;  // CPU time of all of it
    std::int64_t device;
    std::int64_t proxy;

    TickCause cause(std::int64_t lateness, std::int64_t work) const {
        // A device that waits uses no CPU time; that must not count as the machine's delay.
        if (work > lateness && 2 * device >= work) return TickCause::device;
        // The machine's delay: waking late, and time in which the thread did not run.
        if (lateness + std::max<std::int64_t>(0, work - compute) >= compute) {
            return TickCause::machine;
        }
        const std::int64_t other = work - device - proxy;
        if (device >= std::max(proxy, other)) return TickCause::device;
        return proxy >= other ? TickCause::proxy : TickCause::other;
    }
};

/// The clock for the parts of a tick [ns]. Without a clock, all of them happen at `start`.
struct Servo::TickClock {
    std::int64_t start;
    Clock now = nullptr, cpu_now = nullptr;

    std::int64_t read() const { return now ? now() : start; }
    std::int64_t cpu() const { return cpu_now ? cpu_now() : start; }
};

Servo::Servo(Session session, Device& device, const ServoSettings& settings)
    : commands_(settings.command_room),
      session_(std::move(session)),
      device_(std::make_unique<WatchedDevice>(device)),
      settings_(settings),
      now_(settings.clock ? settings.clock : &monotonic_ns),
      cpu_now_(settings.clock ? settings.clock : &thread_cpu_ns),
      field_(kind_of(session_.renderer.field)),
      recorder_(settings.recorder),
      held_{session_.renderer.field.shared_samples(), session_.renderer.settings.layers,
            session_.renderer.settings.tool} {
    // Refuses settings that no device can render, instead of lowering them.
    check(session_.renderer);
    keep_device_limits(device.info().limits);
    start_ = session_.renderer.settings;
    check(start_);
    limits_ = start_.device;
    check(session_.settings);
    check(command::Speed{session_.speed}, start_, field_);
    make_room_for_tools(session_.renderer);
    if (!(settings.rate >= 250 && settings.rate <= 8000)) {
        throw std::invalid_argument("the servo's rate must be 250 to 8000 Hz");
    }
    if (session_.renderer.settings.device.rate > settings.rate) {
        throw std::invalid_argument(
            "the device settings count on a faster loop than the servo's: springs would not be "
            "stable");
    }
    if (settings.priority < 1 || settings.priority > 99) {
        throw std::invalid_argument("the servo's priority must be 1 to 99");
    }
}

Servo::~Servo() {
    stop();
    if (thread_.joinable()) thread_.join();
    while (stops_.load(std::memory_order_acquire) > 0) std::this_thread::sleep_for(poll);
}

void Servo::start() {
    State idle = State::idle;
    if (!state_.compare_exchange_strong(idle, State::running)) {
        throw std::logic_error("a servo is started once");
    }
    try {
        device_->watch(settings_.real_time ? std::min(settings_.priority + 1, 99) : 0);
        thread_ = std::thread([this] { run(); });
    } catch (...) {
        state_.store(State::ended);
        throw;
    }
    // Polls, as this happens once and does not take long.
    while (!ready_.load(std::memory_order_acquire)) std::this_thread::sleep_for(poll);
}

/// Polls, too, so that the servo thread need not wake waiting threads. Only the destructor joins
/// it, and no other function.
void Servo::stop() noexcept {
    stops_.fetch_add(1, std::memory_order_relaxed);
    stopping_.store(true, std::memory_order_release);
    const bool is_servo_thread = std::this_thread::get_id() == thread_id_.load();
    if (is_servo_thread && !in_step_ && is_running()) end(schedule_.last_start);
    while (!is_servo_thread && is_running() && !device_->has_lost_force()) {
        std::this_thread::sleep_for(poll);
    }
    stops_.fetch_sub(1, std::memory_order_release);  // the last that touches the servo
}

bool Servo::record(Queue<SessionEvent>& recorder) {
    if (has_ended()) return true;
    next_point_ = std::make_shared<SessionPoint>();
    hold(next_point_);
    next_recorder_ = &recorder;
    awaited_.store(next_point_.get());
    if (push(CheckedCommand(command::Resume{next_point_}, start_, field_))) return true;
    awaited_.store(nullptr);
    return false;
}

void Servo::stop_recording() noexcept {
    const auto wait = [&] {
        while (in_recorder_.load()) std::this_thread::sleep_for(poll);
    };
    awaited_.store(nullptr);
    wait();  // a recording that begins at this moment has begun
    recorder_.store(nullptr);
    wait();
}

bool Servo::send(const Command& command) {
    if (std::holds_alternative<command::Resume>(command)) {
        throw std::invalid_argument("a running session cannot resume at another point");
    }
    const CheckedCommand checked(command, start_, field_);
    const bool over = has_ended();
    // A session that continues gets the newest samples from elsewhere.
    const bool is_late = over && std::holds_alternative<command::Samples>(command);
    if (!is_late && take(checked)) return true;
    if (over) sent_.fetch_add(1, std::memory_order_relaxed);  // waits for good
    return over;
}

/// False if the queue is full.
bool Servo::take(const CheckedCommand& checked) {
    const Command& command = checked.command();
    if (const auto* samples = std::get_if<command::Samples>(&command)) {
        hold(samples->samples);
        hold(samples->recipe);
    }
    if (const auto* layers = std::get_if<command::UseLayers>(&command)) hold(layers->layers);
    if (const auto* tool = std::get_if<command::UseTool>(&command)) hold(tool->tool);
    if (const auto* limits = std::get_if<DeviceLimits>(&command)) return lower(*limits, checked);
    return push(checked);
}

std::int64_t Servo::sure_tick() const noexcept {
    const auto now = snapshot();  // before the commands are counted
    const std::int64_t begun = now ? now->number : -1;
    return begun + 2 + std::max<std::int64_t>(0, waiting() - 1) / commands_per_tick;
}

bool Servo::lower(const DeviceLimits& limits, const CheckedCommand& checked) {
    const std::lock_guard lock(sent_mutex_);
    const DeviceLimits lowered = smaller(limits_, limits);
    if (lowered == limits_ && limits != limits_) {
        throw std::invalid_argument(
            "limits can only be lowered, and the delay raised: none of these does it");
    }
    if (!push(checked)) return false;
    limits_ = lowered;
    return true;
}

bool Servo::push(const CheckedCommand& checked) {
    sent_.fetch_add(1, std::memory_order_relaxed);  // before the servo thread can count it
    if (commands_.push(checked)) return true;
    sent_.fetch_sub(1, std::memory_order_relaxed);
    return false;
}

/// Drops objects that nothing else holds any more, and holds this one: once, however often it is
/// sent, because with two entries it would never look unused.
void Servo::hold(const std::shared_ptr<const void>& sent) {
    if (!sent) return;
    const std::lock_guard lock(sent_mutex_);
    std::erase_if(held_, [](const auto& held) { return held.use_count() == 1; });
    if (std::find(held_.begin(), held_.end(), sent) == held_.end()) held_.push_back(sent);
}

ServoReport Servo::report() const noexcept {
    ServoReport report;
    report.ticks = ticks_.load(std::memory_order_relaxed);
    report.missed = missed_.load(std::memory_order_relaxed);
    report.overruns = overruns_.load(std::memory_order_relaxed);
    report.unrecorded = unrecorded_.load(std::memory_order_relaxed);
    report.period = period_.summary();
    report.lateness = lateness_.summary();
    report.work = work_.summary();
    report.compute = compute_.summary();
    report.worst = worst_.get().value_or(WorstTick{});
    return report;
}

std::int64_t Servo::waiting() const noexcept {
    // In this order: never below 0.
    const std::int64_t obeyed = obeyed_.load(std::memory_order_acquire);
    return sent_.load(std::memory_order_relaxed) - obeyed;
}

DeviceFailure Servo::device_failure() const noexcept {
    return device_->failure();
}

bool Servo::has_ended() const noexcept {
    return stopping_.load(std::memory_order_acquire) || device_->failure() != DeviceFailure::none ||
           state_.load(std::memory_order_acquire) == State::ended;
}

bool Servo::is_running() const noexcept {
    return state_.load(std::memory_order_acquire) == State::running;
}

const Session& Servo::session() {
    if (is_running()) throw std::logic_error("a running servo's session is its own");
    while (const std::optional<CheckedCommand> checked = commands_.pop()) {
        const bool records = std::holds_alternative<command::Resume>(checked->command());
        if (!records) apply(session_, *checked);  // nothing more is recorded
        add(obeyed_, 1);
    }
    return session_;
}

void Servo::watch(std::int64_t cpu, bool could_run) noexcept {
    device_->look({cpu, could_run});
}

void Servo::run() noexcept {
    try {
        privileges_ = settings_.real_time ? ask_for_real_time(settings_.priority)
                                          : std::vector<std::string>{"real time: not requested"};
    } catch (...) {  // no memory for the sentences; the loop needs none
    }
    begin(now_() + settle_ns);
    ready_.store(true, std::memory_order_release);
    Alarm alarm;
    do {
        alarm.sleep_until(due());
    } while (step());
}

bool Servo::step() noexcept {
    return step(TickClock{now_(), now_, cpu_now_});
}

bool Servo::step(std::int64_t now) noexcept {
    return step(TickClock{now});
}

bool Servo::step(const TickClock& clock) noexcept {
    State idle = State::idle;
    if (state_.compare_exchange_strong(idle, State::running)) begin(clock.start);
    if (state_.load(std::memory_order_relaxed) == State::ended) return false;
    in_step_ = true;
    if (!has_ended()) tick(clock);
    const bool over = has_ended();
    in_step_ = false;
    if (over) end(clock.read());
    return !over;
}

/// Called by the thread that steps.
void Servo::begin(std::int64_t first_tick) noexcept {
    thread_id_.store(std::this_thread::get_id());
    device_->watch_this_thread();
    schedule_.period = static_cast<std::int64_t>(1e9 / settings_.rate);
    schedule_.zero = schedule_.due = first_tick;
}

/// Only when the force is gone: the watchdog may still be in Device::stop() for a call that hung
/// and has returned since.
void Servo::end(std::int64_t now) noexcept {
    device_->write({}, 1e-9 * static_cast<double>(now - schedule_.zero));
    while (device_->is_losing_force()) std::this_thread::sleep_for(poll);
    state_.store(State::ended, std::memory_order_release);
}

void Servo::tick(const TickClock& clock) noexcept {
    const std::int64_t start = clock.start;
    const std::int64_t compute_start = clock.cpu();
    const std::int64_t number = ticks_.load(std::memory_order_relaxed);
    const double time = 1e-9 * static_cast<double>(start - schedule_.zero);

    obey();
    const std::int64_t before_read = clock.read();
    const DeviceReading reading = device_->read(time);
    const std::int64_t after_read = clock.read();
    if (device_->failure() != DeviceFailure::none) return show_failure();
    if (reading.limits) keep_device_limits(*reading.limits);
    SessionTick result = advance(session_, time, reading, clock.now);
    const std::int64_t before_write = clock.read();
    if (1e-9 * static_cast<double>(before_write - start) > session_.settings.overrun) {
        drop_force(session_, result);
        add(overruns_, 1);
    }
    device_->write({result.tick.force, result.tick.torque}, time);
    const std::int64_t after_write = clock.read();
    if (device_->failure() != DeviceFailure::none) return show_failure();
    publish(number, result);
    record(result);

    if (!clock.now) {  // nothing to time
        schedule_.last_start = start;
        add(ticks_, 1);
        return;
    }
    count(number,
          {.start = start,
           .compute = clock.cpu() - compute_start,
           .device = (after_read - before_read) + (after_write - before_write),
           .proxy = result.tick.update_ns},
          clock.read());
}

void Servo::count(std::int64_t number, const Stamps& stamps, std::int64_t end) noexcept {
    const WorstTick tick{number, stamps.start - schedule_.due, end - stamps.start, stamps.compute,
                         stamps.cause(stamps.start - schedule_.due, end - stamps.start)};
    lateness_.add(tick.lateness_ns);
    work_.add(tick.work_ns);
    compute_.add(tick.compute_ns);
    if (number > 0) period_.add(stamps.start - schedule_.last_start);
    schedule_.last_start = stamps.start;
    if (tick.lateness_ns + tick.work_ns > schedule_.worst.lateness_ns + schedule_.worst.work_ns) {
        schedule_.worst = tick;
        worst_.put(tick);
    }
    // A tick that ends after the next one was due has missed that deadline. Of the ticks that came
    // due meanwhile, only the last one is made up.
    const std::int64_t late = std::max<std::int64_t>(0, (end - schedule_.due) / schedule_.period);
    add(missed_, late);
    schedule_.due += schedule_.period * std::max<std::int64_t>(1, late);
    add(ticks_, 1);
}

void Servo::obey() noexcept {
    for (int i = 0; i < commands_per_tick; ++i) {
        const std::optional<CheckedCommand> checked = commands_.pop();
        if (!checked) return;
        if (const auto* from = std::get_if<command::Resume>(&checked->command())) {
            begin_recording(*from);
            continue;
        }
        apply(session_, *checked);
        const auto* samples = std::get_if<command::Samples>(&checked->command());
        // Held until they are written, samples would be in memory long after the servo uses others.
        record(samples && samples->recipe
                   ? Command(command::Samples{nullptr, samples->version, samples->recipe})
                   : checked->command());
        obeyed_.store(obeyed_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
    }
}

/// From here on, unless it was stopped before.
void Servo::begin_recording(const command::Resume& from) noexcept {
    in_recorder_.store(true);
    const bool begins = awaited_.load() == from.point.get();
    if (begins) {
        checkpoint(session_, *next_point_);
        recorder_.store(next_recorder_);
    }
    in_recorder_.store(false);
    if (begins) {
        const RendererSettings& settings = session_.renderer.settings;
        record(Command(settings.device));
        record(Command(settings.force));
        record(Command(settings.transform));
        record(Command(from));
    }
    obeyed_.store(obeyed_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

/// Limits that change the session go into the recording as the command that does the same.
void Servo::keep_device_limits(const DeviceLimits& limits) noexcept {
    if (keep_within(session_, limits)) record(Command(limits));
}

void Servo::record(const SessionEvent& event) noexcept {
    // In one order for all threads: stop_recording() sees the mark, or this the null.
    in_recorder_.store(true);
    Queue<SessionEvent>* const recorder = recorder_.load();
    if (recorder && !recorder->push(event)) add(unrecorded_, 1);
    in_recorder_.store(false);
}

/// Shows the tick before. Uses nothing outside the servo, which may be gone, because no thread
/// waits for one that hangs.
void Servo::show_failure() noexcept {
    Snapshot last = snapshot_.get().value_or(Snapshot{});
    last.session.device.status = DeviceStatus::fault;
    drop_force(session_, last.session);
    snapshot_.put(last);
}

void Servo::publish(std::int64_t number, const SessionTick& tick) noexcept {
    snapshot_.put(snapshot_of(session_, tick, number, missed_.load(std::memory_order_relaxed)));
}

}  // namespace palpate
