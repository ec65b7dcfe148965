// Starting, changing and ending sessions.
#include "apps/viewer/model/live.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace palpate::viewer {

Live::Live(app::LoadedVolume loaded, const app::TouchOptions& options)
    : Live(app::make_scene(std::move(loaded), options), options) {}

Live::Live(app::LiveScene scene, const app::TouchOptions& options)
    : loaded_(std::move(scene.loaded)),
      options_(options),
      field_(std::move(scene.field)),
      session_settings_(scene.session.settings) {
    hold(std::move(scene.device));
    start(std::move(scene.session));
}

Live::~Live() {
    servo_->stop();
    device_->stop();
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
    servo_ = std::make_unique<Servo>(
        std::move(session), *device_,
        ServoSettings{.rate = options_.render.rate,
                      .real_time = !options_.normal_priority,
                      .recorder = recording_ ? &recording_->queue() : nullptr});
    servo_->start();
}

/// A new one with all that was asked for, and the level and place to which penetrability, clutch
/// and scale have led.
Session Live::session_from(double isovalue, const DeviceTransform& transform) const {
    RendererSettings settings = settings_;
    settings.transform = transform;
    return {make_renderer(field_, std::isfinite(isovalue) ? isovalue : isovalue_, settings),
            session_settings_};
}

/// The same from where the session that has stopped left off.
Session Live::session_after() const {
    const Renderer& last = servo_->session().renderer;
    return session_from(last.proxy.isovalue, last.settings.transform);
}

void Live::send(const Command& command) {
    if (!servo_->send(command)) {
        throw std::invalid_argument("too many commands at once: one was left out");
    }
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
    app::LiveScene scene = app::make_scene(loaded_, options);
    const RendererSettings& fitted = scene.session.renderer.settings;
    RendererSettings settings = settings_;
    settings.device = fitted.device;
    settings.transform = fitted.transform;
    settings.force.limit = fitted.force.limit;
    settings.force.stiffness = std::min(settings.force.stiffness, fitted.force.stiffness);
    Session session{make_renderer(field_, isovalue_, settings), scene.session.settings};

    stop_recording();
    servo_->stop();
    device_->stop();
    servo_.reset();
    options_ = std::move(options);
    session_settings_ = session.settings;
    hold(std::move(scene.device));
    start(std::move(session));
}

void Live::use_field(Solid solid, std::optional<double> background) {
    Field field(loaded_.volume, solid, background);
    stop_recording();
    servo_->stop();
    field_ = std::move(field);
    settings_.penetrability = no_penetrability();
    start(session_after());
}

void Live::record(const std::filesystem::path& path) {
    stop_recording();
    const auto now = servo_->snapshot();
    Session session = session_from(now ? now->session.tick.proxy.isovalue : isovalue_,
                                   now ? now->session.transform : settings_.transform);
    auto recording = std::make_unique<io::RecordingWriter>(
        path, app::recording_head(session, device_->info(), options_));
    servo_->stop();
    recording_ = std::move(recording);
    start(std::move(session));
}

std::int64_t Live::stop_recording() {
    if (!recording_) return 0;
    servo_->stop();
    const std::int64_t lost = servo_->report().unrecorded;
    const auto recording = std::move(recording_);
    start(session_after());  // first the hand, then the file
    recording->finish(lost);
    return recording->ticks();
}

}  // namespace palpate::viewer
