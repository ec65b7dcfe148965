// Starts runs, restores their settings, finds and changes devices.
#include "apps/viewer/window/run_controller.hpp"

#include <utility>

#include "apps/viewer/panel/device_controls.hpp"
#include "apps/viewer/panel/isovalue_controls.hpp"
#include "apps/viewer/panel/loop_view.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/messages.hpp"

namespace palpate::viewer {

RunController::RunController(const RunRequest& request, Content& content, Panel& panel,
                             Messages& messages)
    : request_(request), content_(content), panel_(panel), messages_(messages), search_(messages) {
    connect(&content, &Content::run_changed, this, &RunController::show_terraces);
    connect(&panel.device_controls(), &DeviceControls::chosen, this, &RunController::use_device);
    connect(&panel.device_controls(), &DeviceControls::refresh_wanted, this,
            &RunController::find_devices);
    connect(&panel.isovalue_controls(), &IsovalueControls::field_wanted, this,
            &RunController::use_field);
    since_report_.start();
}

RunRequest RunController::take_request() {
    RunRequest request = request_;
    request_.setup.field.isovalue.reset();
    request_.setup.render.layers.reset();
    request_.record.clear();
    return request;
}

void RunController::set_first_isovalue(double isovalue) {
    const run::Setup& setup = request_.setup;
    if (setup.field.isovalue || setup.render.layers) return;  // layers have levels of their own
    request_.setup.field.isovalue = isovalue;
}

QString RunController::device_words() const {
    QStringList names;
    for (const devices::DeviceFinding& finding : findings_) {
        const bool made =
            finding.name == "mouse" || finding.name == "simulated" || finding.name == "recorded";
        if (finding.found && !made) names << QString::fromStdString(finding.name);
    }
    if (names.isEmpty()) return tr("No haptic device was found: the mouse is the hand.");
    return tr("Found: %1. Choose it under Device.").arg(names.join(", "));
}

void RunController::start(std::shared_ptr<Opened> volume, const run::Setup& setup) {
    content_.start_run(std::move(volume), setup);
    QString words =
        tr("Felt through the device %1").arg(QString::fromStdString(run::text_of(setup.device)));
    for (const std::string& sentence : content_.live()->privileges()) {
        words += "; " + QString::fromStdString(sentence);
    }
    messages_.show_done(words);
    show_devices();
    Q_EMIT device_changed();
}

void RunController::restore(const RendererSettings& settings) {
    const auto send = [this](const Command& command) { content_.effect().request(command); };
    if (!settings.tool) send(command::UseTool{nullptr});  // beside one, other things are refused
    send(settings.force);
    send(settings.proxy.friction);
    send(settings.penetrability);
    if (settings.layers && !lack_labels(settings.layers)) {
        send(command::UseLayers{settings.layers});
    }
    if (settings.tool) send(command::UseTool{settings.tool});
    send(settings.transform);
    send(command::Forces{settings.forces_on});
    Q_EMIT content_.run_changed();
}

void RunController::find_devices() {
    if (search_.busy()) return;
    auto found = std::make_shared<std::vector<devices::DeviceFinding>>();
    search_.start(
        tr("Looking for devices"),
        [found](const io::Progress&) { *found = devices::find_devices(); },
        [this, found] {
            findings_ = *found;
            show_devices();
            Q_EMIT devices_found();
        });
}

void RunController::show_devices() {
    const devices::DeviceChoice& current =
        content_.live() ? content_.live()->setup().device : request_.setup.device;
    panel_.device_controls().set_devices(findings_, QString::fromStdString(run::text_of(current)));
    status_.reset();
}

void RunController::show_terraces() {
    const Opened& opened = *content_.volume();
    const bool on = opened.loaded.source.dequantize > 0;
    panel_.isovalue_controls().set_dequantized(
        on, on || opened.terraces,
        opened.terraces ? QString::fromStdString(filters::reason_to_dequantize(*opened.terraces))
                        : QString());
}

void RunController::use_device(const QString& option) {
    messages_.guarded([&] {
        const devices::DeviceChoice device = devices::parse_device(option.toStdString());
        if (run::Run* live = content_.live()) {
            const bool recorded = live->recording() && live->recording()->ticks() > 0;
            content_.use_device(device);
            if (recorded) messages_.show_done(tr("Recorded up to the other device"));
            Q_EMIT device_changed();
        }
        request_.setup.device = device;
    });
    show_devices();
}

void RunController::use_field(Solid solid, Interpolation interpolation) {
    if (!content_.live()) return;
    const Field& now = content_.live()->field();
    if (now.solid() == solid && now.interpolation() == interpolation) return;
    messages_.guarded([&] { content_.use_field(solid, interpolation); });
}

void RunController::observe(const Snapshot& now) {
    const run::Run* live = content_.live();
    if (!live) return;
    const DeviceStatus status = now.session.device.status;
    const QString problem = QString::fromStdString(live->device_problem());
    if (status == status_ && problem == problem_) return;
    status_ = status;
    problem_ = problem;
    panel_.device_controls().show_device(live->device(), status, problem);
}

void RunController::show_report() {
    if (!content_.live()) return;
    const ServoReport report = content_.live()->report();
    const double seconds = 1e-3 * static_cast<double>(since_report_.restart());
    const std::int64_t ticks = report.ticks - std::exchange(reported_ticks_, report.ticks);
    // Fewer than before: another servo.
    if (ticks < 0 || !(seconds > 0)) return;
    panel_.loop_view().show_report(report, static_cast<double>(ticks) / seconds);
}

}  // namespace palpate::viewer
