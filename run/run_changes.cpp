// Continues a run with another device, other buttons or another field.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "devices/absent_device.hpp"
#include "devices/claim.hpp"
#include "io/system/number.hpp"
#include "palpate/run/run.hpp"
#include "run/session_settings.hpp"

namespace palpate::run {
namespace {

/// The field that simulated hands see. For a store, of which little may be in memory, this is the
/// overview.
Field seen(const Field& field) {
    if (!field.samples().resident()) return field;
    return Field(flattened(field.samples()), field.solid(), field.background(),
                 field.interpolation());
}

/// The same device with other options, or another one of the same kind, whose motors then count as
/// warmer than they are for a minute or so.
bool may_have_the_same_motors(const devices::DeviceChoice& a, const devices::DeviceChoice& b) {
    return a.name == b.name;
}

}  // namespace

/// If the device is the one that this run has, `close` closes it first.
std::unique_ptr<Device> Run::open_for(const Setup& setup, double isovalue,
                                      const OnProgress& progress,
                                      const std::function<void()>& close) const {
    const double rate = setup.render.rate.value_or(usual_rate);
    if (!(rate >= 250 && rate <= 8000)) {
        std::string text;
        io::append_number(text, rate);
        throw std::invalid_argument("rate " + text + " Hz: a live session runs at 250 to 8000 Hz");
    }
    const devices::OpenedBy opened_by(this, close);
    return setup.open_device(
        setup.device,
        {seen(field_), isovalue, rate,
         [&](const DeviceInfo& info) { return transform_for(field_.geometry(), info, setup); },
         progress});
}

void Run::start_as(Run& before) {
    if (servo_) throw WrongState("a run starts once");
    before.started_servo();
    Setup setup = setup_;
    setup.buttons = before.setup_.buttons;  // they may have been chosen after this run was made
    // Throws before anything has changed.
    Session session =
        before.session_for(settings_, session_settings(setup, device()), before.device());
    before.stop_servo();
    before.running_ = false;
    const bool hangs = before.servo_->is_running();
    if (!hangs && may_have_the_same_motors(setup_.device, before.setup_.device)) {
        session.renderer.force.motors.warmth =
            before.servo_->session().renderer.force.motors.warmth;
    }
    const bool stays_frozen = setup_.device == before.setup_.device && before.frozen_;
    try {
        setup_ = std::move(setup);
        field_ = before.field_;
        hold(std::move(device_));
        launch(std::move(session));
    } catch (...) {  // the system gives no thread or no memory
        if (!hangs && !before.is_over_) {
            before.stop_recording();
            before.launch(before.session_stopped());
        }
        throw;
    }
    before.is_over_ = true;
    before.device_->stop();
    if (stays_frozen) send(command::Freeze{true});
}

void Run::start_beside(const Run& first) {
    if (servo_) throw WrongState("a run starts once");
    Setup setup = setup_;
    setup.buttons = first.setup_.buttons;
    session_settings_ = session_settings(setup, device());
    setup_ = std::move(setup);
    const bool other_side = first.field_.solid() != field_.solid();
    if (other_side) settings_.layers = nullptr;  // their order is that of the side
    if (other_side || first.field_.interpolation() != field_.interpolation()) {
        settings_.penetrability = no_penetrability();
    }
    field_ = first.field_;
    start();
}

void Run::close_device() {
    stop_recording();
    halt();
    require_answer();
    left_behind_ = unanswered();
    last_resort_.reset();
    device_.reset();
}

/// The level that was asked for, or one of the volume where none was.
double Run::some_isovalue(const OnProgress& progress) const {
    return std::isfinite(isovalue_) ? isovalue_ : isovalue_of(data_->loaded(), setup_, progress);
}

void Run::use_device(const devices::DeviceChoice& device, const OnProgress& progress) {
    servo_to_replace();  // throws before anything has changed
    require_answer();
    left_behind_.clear();
    Setup setup = setup_;
    setup.device = device;
    const DeviceInfo old = device_->info();
    const double isovalue = some_isovalue(progress);  // a simulated hand goes for its surface
    if (progress) progress(1);
    try {
        auto opened = open_for(setup, isovalue, progress, [this] { close_device(); });
        const bool are_warm = !device_ || may_have_the_same_motors(device, setup_.device);
        const Session fitted = make_session(field_, isovalue, opened->info(), setup, progress);
        Session session = session_for(fitted.renderer.settings, fitted.settings, old);
        if (device_) close_device();
        if (are_warm) {
            session.renderer.force.motors.warmth = servo_->session().renderer.force.motors.warmth;
        }
        setup_ = std::move(setup);
        hold(std::move(opened));
        launch(std::move(session));
    } catch (...) {
        if (!device_) reopen(isovalue, old);
        throw;
    }
}

/// A new session with everything that was asked for, lowered where the device for which `fit` was
/// made cannot render it.
Session Run::session_for(const RendererSettings& fit, const SessionSettings& session,
                         const DeviceInfo& old) const {
    RendererSettings settings = settings_;
    settings.device = fit.device;
    settings.transform = fit.transform;
    // A limit that was asked for stays; one that was the old device's becomes the new one's.
    if (settings.force.limit >= old.limits.maximum_force) settings.force.limit = fit.force.limit;
    settings.force.stiffness = std::min(settings.force.stiffness, fit.force.stiffness);
    return {make_renderer(field_, isovalue_, settings), session};
}

/// The device that was closed for a choice which could not be opened.
void Run::reopen(double isovalue, const DeviceInfo& old) {
    try {
        hold(open_for(setup_, isovalue));
    } catch (const std::exception& error) {
        hold(std::make_unique<devices::AbsentDevice>(old, "it could not be opened again (" +
                                                              std::string(error.what()) +
                                                              "): choose it once more"));
    }
    launch(session_stopped());
}

void Run::use_buttons(const Buttons& buttons) {
    servo_to_replace();
    require_answer();
    Setup setup = setup_;
    setup.buttons = buttons;
    const SessionSettings session = session_settings(setup, device());
    stop_recording();
    stop_servo();
    session_settings_ = session;
    setup_ = std::move(setup);
    launch(session_stopped());
}

void Run::use_field(Solid solid, Interpolation interpolation, std::optional<double> background) {
    servo_to_replace();
    require_answer();
    Field field(data_->start(), solid, background, interpolation);
    RendererSettings settings = settings_;
    if (solid != field_.solid()) settings.layers = nullptr;  // their order is that of the side
    settings.penetrability = no_penetrability();
    (void)make_renderer(field, isovalue_, settings);  // throws before anything has changed
    stop_recording();
    stop_servo();
    field_ = std::move(field);
    settings_ = std::move(settings);
    launch(session_stopped());
}

}  // namespace palpate::run
