// Starts and ends a run, passes commands on, and records it. Its changes: run_changes.cpp.
#include "palpate/run/run.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <stdexcept>
#include <thread>
#include <utility>

#include "palpate/run/beside.hpp"

namespace palpate::run {
namespace {

std::string utc_now() {
    using namespace std::chrono;
    const auto now = floor<seconds>(system_clock::now());
    const auto day = floor<days>(now);
    const year_month_day date(day);
    const hh_mm_ss time(now - day);
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02dZ",
                  static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                  static_cast<unsigned>(date.day()), static_cast<int>(time.hours().count()),
                  static_cast<int>(time.minutes().count()),
                  static_cast<int>(time.seconds().count()));
    return text.data();
}

/// After such a command, a hand that stands still may touch what it did not touch before.
bool moves_contact(const Command& command) {
    const Overloaded moves{
        [](const ForceSettings&) { return false; },    [](const Friction&) { return false; },
        [](const DeviceLimits&) { return false; },     [](const command::Forces&) { return false; },
        [](const command::Samples&) { return false; }, [](const auto&) { return true; }};
    return std::visit(moves, command);
}

/// Layers by label that come without orientation or spacing lie where they were given for the data.
Command placed_beside(Command command, const LoadedVolume& loaded) {
    const auto* use = std::get_if<command::UseLayers>(&command);
    if (!use || !use->layers) return command;
    auto labels = labels_beside(use->layers->labels, loaded);
    if (labels == use->layers->labels) return command;
    Layers layers = *use->layers;
    layers.labels = std::move(labels);
    std::get<command::UseLayers>(command).layers = std::make_shared<const Layers>(layers);
    return command;
}

/// The same of the layers with which a run begins.
Setup placed_beside(Setup setup, const LoadedVolume& loaded) {
    if (auto& file = setup.render.layers) {
        file->layers.labels = labels_beside(file->layers.labels, loaded);
    }
    return setup;
}

/// Interval between steps of data and recording, with Pace::by_steps [s].
constexpr double between_steps = 0.004;
/// How long stop() waits for a device that hangs.
constexpr std::chrono::milliseconds longest_stop{500};

}  // namespace

io::RecordingHead recording_head(const Session& session, const DeviceInfo& device,
                                 const io::VolumeIdentity& volume, const RenderSetup& setup) {
    const Field& field = session.renderer.field;
    io::RecordingHead head;
    head.version = PALPATE_VERSION;
    head.begun = utc_now();
    head.volume = volume;
    head.solid = field.solid();
    head.interpolation = field.interpolation();
    head.background = field.background();
    head.isovalue = session.renderer.proxy.isovalue;
    head.device = device.name + " (" + device.model + ")";
    head.rate = rate_of(setup, device);
    head.method = setup.method.name;
    head.settings = session.renderer.settings;
    head.session = session.settings;
    return head;
}

Run::Run(std::shared_ptr<Data> data, const Setup& setup, const OnProgress& progress)
    : data_(std::move(data)),
      setup_(placed_beside(setup, data_->loaded())),
      field_(make_field(data_->start(), setup.field, setup.render.method.method)) {
    const double isovalue = isovalue_of(data_->loaded(), setup_, progress);
    if (progress) progress(1);
    auto device = open_for(setup_, isovalue, progress);
    take(make_session(field_, isovalue, device->info(), setup_, progress));
    hold(std::move(device));
}

Run::~Run() {
    stop();
    try {
        stop_recording();
    } catch (const io::OutputError&) {  // RecordingWriter::problem() told it while it ran
    }
}

void Run::start() {
    if (servo_) throw WrongState("a run starts once");
    if (is_over_) throw WrongState("the run was stopped before it started: make another one");
    hold(std::move(device_));  // this thread may be another than the one that opened it
    launch(session_now());
}

void Run::step() {
    if (!running_ || data_->pace() != Pace::by_steps) {
        throw WrongState("a run is stepped on data of that pace, from start() to stop()");
    }
    servo_->step(std::llround(1e9 * period_ * static_cast<double>(steps_++)));
    time_ += period_;
    if (time_ - told_ < between_steps) return;
    told_ = time_;
    if (recording_) recording_->step();
    using namespace std::chrono;
    data_->step(steady_clock::time_point(duration_cast<nanoseconds>(duration<double>(time_))));
}

void Run::stop() {
    is_over_ = true;
    halt();
}

/// As stop(), but another servo may follow.
void Run::halt() {
    if (running_) stop_servo();
    device_->stop();
    // The zero is for the device's thread to send; until then its motors hold the last force.
    const auto latest = std::chrono::steady_clock::now() + longest_stop;
    while (servo_ && device_->is_stopping() && std::chrono::steady_clock::now() < latest) {
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    running_ = false;
}

std::string Run::unanswered() const {
    if (running_ || !servo_ || !device_->is_stopping()) return {};
    return "the device '" + device_->info().name +
           "' does not answer, so its force may still be on: it gets a force of zero as soon as it "
           "answers";
}

Servo& Run::started_servo() const {
    if (!servo_) throw WrongState("the run was not started");
    return *servo_;
}

/// For what starts another servo.
Servo& Run::servo_to_replace() const {
    Servo& servo = started_servo();
    if (is_over_) throw WrongState("the run has stopped for good: make another one");
    return servo;
}

void Run::hold(std::unique_ptr<Device> device) {
    last_resort_.reset();
    device_ = std::move(device);
    mouse_ = dynamic_cast<devices::Mouse*>(device_.get());
    last_resort_.emplace(*device_);
}

void Run::take(const Session& session) {
    session_settings_ = session.settings;
    settings_ = session.renderer.settings;
    isovalue_ = session.renderer.proxy.isovalue;
    frozen_ = session.frozen;
}

void Run::launch(Session session) {
    take(session);
    const double rate = rate_of(setup_.render, device_->info());
    period_ = 1 / rate;
    steps_ = 0;
    const Pace pace = data_->pace();
    const ServoSettings settings{.rate = rate,
                                 .real_time = setup_.real_time,
                                 .recorder = recording_ ? &recording_->queue(hand_) : nullptr};
    servo_ = data_->attach(std::move(session), [&](Session now, const auto& history) {
        if (recording_) recording_->begin_with(history, hand_);
        auto servo = std::make_unique<Servo>(std::move(now), *device_, settings);
        if (pace == Pace::own_thread) servo->start();
        return servo;
    });
    tell_begin();
    running_ = true;
    lost_before_ = 0;
}

void Run::stop_servo() {
    servo_->stop();
    data_->detach(*servo_);
}

Field Run::field_now() const {
    Field field = field_;
    data_->update(field);
    return field;
}

/// Throws devices::DeviceError while a call of the driver does not return: the servo's thread is
/// still in the device, so neither the session nor the device can be taken from it.
void Run::require_answer() const {
    if (device_failure() != DeviceFailure::hung || !servo_->is_running()) return;
    throw devices::DeviceError("the device '" + device_->info().name + "': " + device_problem());
}

/// A new session with everything that was asked for, at the place of the servo that has stopped:
/// penetrability, clutch and scale may have led elsewhere, and the proxy stays on its side of the
/// surface that it touches. A level of layers does not count.
Session Run::session_stopped() {
    require_answer();
    const Session& last = servo_->session();
    RendererSettings settings = settings_;
    settings.transform = last.renderer.settings.transform;
    const double level =
        last.renderer.isovalue_without_layers.value_or(last.renderer.proxy.isovalue);
    Session session{make_renderer(field_, std::isfinite(level) ? level : isovalue_, settings),
                    session_settings_};
    take_up(session, last);
    return session;
}

/// As the running servo has it now, or as the first one will begin. What it has not carried out yet
/// is in what was asked for.
Session Run::session_now() const {
    RendererSettings settings = settings_;
    double isovalue = isovalue_;
    const auto now = servo_ && servo_->waiting() == 0 ? servo_->snapshot() : std::nullopt;
    if (now) {
        settings.transform = now->session.transform;
        const double level = now->session.tick.proxy.isovalue;
        if (std::isfinite(level) && !have_surfaces(settings.layers)) isovalue = level;
    }
    return {make_renderer(field_, isovalue, settings), session_settings_};
}

DeviceFailure Run::device_failure() const {
    return servo_ ? servo_->device_failure() : DeviceFailure::none;
}

std::string Run::device_problem() const {
    const DeviceFailure failure = device_failure();
    if (failure == DeviceFailure::none) {
        const std::string force = unanswered();
        return force.empty() ? device_->problem() : force;
    }
    return std::string(name_of(failure)) +
           ": the session has ended and the force is zero; check the device, then start again";
}

/// Samples that an application sends are an edit. Otherwise the next one would be made of the
/// samples before, and neither further hands nor files would have those that are felt.
static void replace(const Data& data, const command::Samples& by) {
    if (by.samples->frames().size() > 1) {
        throw std::invalid_argument(
            "samples for a run are those of one moment: open a sequence as the run's volume");
    }
    data.editor().apply(edit::Replace{Index3::Zero(), flattened(*by.samples)});
}

void Run::send(const Command& asked) {
    Servo& servo = started_servo();
    if (!running_) throw WrongState("the run has stopped, so it carries out no more commands");
    const Command command = placed_beside(asked, data_->loaded());
    check(command, settings_, kind_of(field_));
    // Of the data, so of all its runs.
    if (const auto* to = std::get_if<command::Samples>(&command)) return replace(*data_, *to);
    // These throw for data that is no sequence.
    if (const auto* to = std::get_if<command::Speed>(&command)) {
        return data_->player().play(to->speed);
    }
    if (const auto* to = std::get_if<command::Moment>(&command)) {
        return data_->player().seek(to->time);
    }
    if (!servo.send(command)) {
        throw QueueFull("too many commands at once: one was left out");
    }
    Session changed{{field_, settings_, {}, {}}, session_settings_};
    changed.renderer.proxy.isovalue = isovalue_;
    if (settings_.tool) changed.renderer.tool_proxy.emplace(settings_.tool);
    changed.frozen = frozen_;
    apply(changed, command);
    settings_ = changed.renderer.settings;
    isovalue_ = changed.renderer.proxy.isovalue;
    frozen_ = changed.frozen;
    if (moves_contact(command)) data_->rest_brush(*servo_, settings_.tool);
}

void Run::record(const std::filesystem::path& path, const OnProgress& progress) {
    Run* const self = this;
    record_together(std::span(&self, 1), path, progress);
}

void Run::record_together(std::span<Run* const> runs, const std::filesystem::path& path,
                          const OnProgress& progress) {
    if (runs.empty()) throw std::invalid_argument("there is no run to record");
    Data& data = *runs.front()->data_;
    std::vector<io::RecordingHead> heads;
    for (Run* const run : runs) {
        if (run->data_.get() != &data) {
            throw std::invalid_argument("only runs on the same data can be recorded together");
        }
        if (std::ranges::count(runs, run) > 1) {
            throw std::invalid_argument("a run is recorded once, not as two hands");
        }
        if (run->started() && !run->running_) {
            throw WrongState("the run has stopped, so there is nothing more to record");
        }
        if (heads.empty()) data.check_recording();
        heads.push_back(recording_head(run->session_now(), run->device_->info(),
                                       data.identity(progress), run->setup_.render));
    }
    const auto recording = std::make_shared<io::RecordingWriter>(path, heads, data.pace());
    std::exception_ptr lost;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        Run& run = *runs[i];
        try {
            run.stop_recording(progress);
        } catch (...) {  // it may be of `progress`; the new recording runs
            lost = std::current_exception();
        }
        run.recording_ = recording;
        run.hand_ = static_cast<int>(i) + 1;
        run.recorded_as_ = path;
        data.keep(path);
    }
    try {
        for (Run* const run : runs) {
            if (run->running_) run->record_from_now();
        }
    } catch (...) {  // where a session takes no commands, an empty recording is left
        for (Run* const run : runs) run->drop_recording();
        throw;
    }
    if (lost) std::rethrow_exception(lost);
}

void Run::record_from_now() {
    data_->record(*servo_, [this](const std::vector<Command>& history) {
        recording_->begin_with(history, hand_);
        if (!servo_->record(recording_->queue(hand_))) {
            throw QueueFull("too many commands at once: nothing is recorded");
        }
    });
    tell_begin();
}

/// Servos that are stepped have no common clock.
void Run::tell_begin() {
    if (recording_ && data_->pace() == Pace::own_thread) {
        recording_->set_begin(servo_->begun(), hand_);
    }
}

/// Without its end.
void Run::drop_recording() {
    if (servo_) servo_->stop_recording();
    recording_.reset();
    data_->release(recorded_as_);
}

std::int64_t Run::stop_recording(const OnProgress& progress) {
    return end_recording()(progress);
}

Run::FinishRecording Run::end_recording() {
    if (!recording_) return [](const OnProgress&) { return std::int64_t{0}; };
    if (servo_) servo_->stop_recording();
    const std::int64_t lost = servo_ ? servo_->report().unrecorded - lost_before_ : 0;
    lost_before_ += lost;
    data_->release(recorded_as_);
    return [recording = std::move(recording_), lost, hand = hand_](const OnProgress& progress) {
        recording->finish(lost, hand, progress);
        return recording->ticks(hand);
    };
}

}  // namespace palpate::run
