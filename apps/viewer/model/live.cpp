// Starting, changing and ending sessions.
#include "apps/viewer/model/live.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "io/number.hpp"

namespace palpate::viewer {
namespace {

/// A command that was sent after tick n shows in tick n + sure at the latest.
constexpr std::int64_t sure = 2;

std::string text_of(double value) {
    std::string text;
    io::append_number(text, value);
    return text;
}

app::FieldOptions field_options(const Field& field, double isovalue) {
    return {.isovalue = text_of(isovalue),
            .solid = field.solid() == Solid::below ? "below" : "above",
            .background = text_of(field.background())};
}

}  // namespace

Live::Live(app::LoadedVolume loaded, const app::TouchOptions& options)
    : Live(app::make_scene(std::move(loaded), options), options) {}

Live::Live(app::LiveScene scene, const app::TouchOptions& options)
    : loaded_(std::move(scene.loaded)),
      options_(options),
      field_(std::move(scene.field)),
      data_(std::make_unique<app::DataInHand>(loaded_, field_, options.loader())),
      session_settings_(scene.session.settings) {
    if (data_->is_sequence()) data_->player().play(options.playback);
    hold(std::move(scene.device));
    start(std::move(scene.session));
}

Live::~Live() {
    stop();
    device_->stop();
    try {
        if (recording_) recording_->finish(servo_->report().unrecorded);
    } catch (const io::OutputError&) {  // what is wrong was told while it ran
    }
}

void Live::hold(std::unique_ptr<Device> device) {
    last_resort_.reset();
    device_ = std::move(device);
    mouse_ = dynamic_cast<devices::Mouse*>(device_.get());
    last_resort_.emplace(*device_);
}

/// Takes its settings from the session.
void Live::start(Session session) {
    settings_ = session.renderer.settings;
    isovalue_ = session.renderer.proxy.isovalue;
    frozen_ = false;
    sent_.clear();
    data_->bring(session);
    auto servo = std::make_unique<Servo>(
        std::move(session), *device_,
        ServoSettings{.rate = options_.render.rate,
                      .real_time = !options_.normal_priority,
                      .recorder = recording_ ? &recording_->queue() : nullptr});
    servo->start();
    servo_ = std::move(servo);  // without a thread, the one that has stopped is still there
    data_->attach(servo_.get());
}

void Live::stop() {
    data_->attach(nullptr);
    servo_->stop();
}

/// A new one with all that was asked for, and the level and place to which penetrability, clutch
/// and scale had led by `last`.
Session Live::session_from(double isovalue, const DeviceTransform& transform,
                           std::int64_t last) const {
    RendererSettings settings = settings_;
    settings.transform = transform;
    Session session{make_renderer(field_, std::isfinite(isovalue) ? isovalue : isovalue_, settings),
                    session_settings_};
    for (const Sent& sent : sent_) {
        // Those that may still have waited; all others show in settings_ alone.
        const bool leads = std::holds_alternative<command::Isovalue>(sent.command) ||
                           std::holds_alternative<command::Scale>(sent.command) ||
                           std::holds_alternative<DeviceTransform>(sent.command);
        if (leads && last < sent.after + sure) apply(session, sent.command);
    }
    if (!std::isfinite(session.renderer.proxy.isovalue)) {
        session.renderer.proxy.isovalue = isovalue_;
    }
    return session;
}

std::int64_t Live::last_tick() const {
    const auto now = servo_->snapshot();
    return now ? now->number : -1;
}

/// The same from where the session that has stopped left off.
Session Live::session_after() const {
    const Renderer& last = servo_->session().renderer;
    return session_from(last.proxy.isovalue, last.settings.transform, last_tick());
}

void Live::send(const Command& command) {
    const std::int64_t after = last_tick();
    if (!servo_->send(command)) {
        throw std::invalid_argument("too many commands at once: one was left out");
    }
    while (!sent_.empty() && sent_.front().after + sure <= after) sent_.pop_front();
    sent_.push_back({after, command});
    Session changed{{field_, settings_, {}, {}}, session_settings_};
    changed.renderer.proxy.isovalue = isovalue_;
    changed.frozen = frozen_;
    apply(changed, command);
    settings_ = changed.renderer.settings;
    isovalue_ = changed.renderer.proxy.isovalue;
    frozen_ = changed.frozen;
}

void Live::use_device(const std::string& device) {
    app::TouchOptions options = options_;
    options.device = device;
    // A hand that moves by itself goes for the surface that is felt now.
    options.field = field_options(field_, isovalue_);
    if (!std::isfinite(isovalue_)) options.field.isovalue = options_.field.isovalue;
    app::LiveScene scene = app::make_scene(loaded_, options);
    const RendererSettings& fitted = scene.session.renderer.settings;
    RendererSettings settings = settings_;
    settings.device = fitted.device;
    settings.transform = fitted.transform;
    // A limit that was asked for stays; one that was the old device's becomes the new one's.
    if (settings.force.limit >= device_->info().limits.maximum_force) {
        settings.force.limit = fitted.force.limit;
    }
    settings.force.stiffness = std::min(settings.force.stiffness, fitted.force.stiffness);
    Session session{make_renderer(field_, isovalue_, settings), scene.session.settings};

    stop_recording();
    stop();
    device_->stop();
    options_ = std::move(options);
    session_settings_ = session.settings;
    hold(std::move(scene.device));
    start(std::move(session));
}

void Live::use_field(Solid solid, std::optional<double> background) {
    Field field(loaded_.volume, solid, background);
    stop_recording();
    stop();
    field_ = std::move(field);
    data_->set_field(field_);
    settings_.penetrability = no_penetrability();
    start(session_after());
}

void Live::record(const std::filesystem::path& path) {
    const auto now = servo_->snapshot();
    Session session =
        session_from(now ? now->session.tick.proxy.isovalue : isovalue_,
                     now ? now->session.transform : settings_.transform, now ? now->number : -1);
    auto recording = std::make_unique<io::RecordingWriter>(
        path, app::recording_head(session, device_->info(), options_));
    stop();
    // After it has stopped: an edit that came in between is in it.
    app::tell(*recording, data_->history());
    const std::int64_t lost = servo_->report().unrecorded;
    recording_.swap(recording);
    start(std::move(session));
    if (recording) recording->finish(lost);
}

std::int64_t Live::stop_recording() {
    if (!recording_) return 0;
    stop();
    const std::int64_t lost = servo_->report().unrecorded;
    const auto recording = std::move(recording_);
    start(session_after());  // first the hand, then the file
    recording->finish(lost);
    return recording->ticks();
}

}  // namespace palpate::viewer
