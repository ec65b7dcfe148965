// Starts runs, restores their settings, finds and changes devices.
#include "apps/viewer/window/run_controller.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "apps/viewer/panel/brush_controls.hpp"
#include "apps/viewer/panel/device_controls.hpp"
#include "apps/viewer/panel/hand_switch.hpp"
#include "apps/viewer/panel/isovalue_controls.hpp"
#include "apps/viewer/panel/panel.hpp"
#include "apps/viewer/panel/tool_controls.hpp"
#include "apps/viewer/window/content.hpp"
#include "apps/viewer/window/file_dialogs.hpp"
#include "apps/viewer/window/messages.hpp"
#include "palpate/io/mesh_file.hpp"
#include "palpate/io/tool_file.hpp"

namespace palpate::viewer {

std::vector<run::Setup> RunRequest::setups() const {
    std::vector<run::Setup> hands(1 + others.size(), setup);
    for (std::size_t i = 0; i < others.size(); ++i) hands[i + 1].device = others[i];
    return hands;
}

void RunRequest::use_devices_of(const RunRequest& other) {
    setup.device = other.setup.device;
    setup.buttons = other.setup.buttons;
    others = other.others;
}

RunController::RunController(const Desk& desk, const RunRequest& request)
    : Controller(desk), request_(request), search_(messages_), reader_(messages_) {
    connect(&content_, &Content::run_changed, this, [this] {
        show_terraces();
        panel_.device_controls().set_buttons(content_.live()->setup().buttons);
    });
    connect(&panel_.device_controls(), &DeviceControls::buttons_wanted, this,
            &RunController::use_buttons);
    connect(&panel_.device_controls(), &DeviceControls::chosen, this, &RunController::use_device);
    connect(&panel_.device_controls(), &DeviceControls::added, this, &RunController::add_hand);
    connect(&panel_.device_controls(), &DeviceControls::removed, this, &RunController::remove_hand);
    connect(&content_, &Content::closed, this, [this] { reader_.abandon(); });
    connect(&panel_.tool_controls(), &ToolControls::open_wanted, this, &RunController::ask_tool);
    connect(&panel_.hand_switch(), &HandSwitch::wanted, this, &RunController::choose_hand);
    for (const auto changed : {&Content::run_changed, &Content::playback_started,
                               &Content::hand_changed, &Content::closed}) {
        connect(&content_, changed, this, &RunController::show_hands);
    }
    connect(&content_, &Content::hand_changed, this, [this] {
        show_devices();
        reported_ticks_ = std::numeric_limits<std::int64_t>::max();  // of another servo
    });
    connect(&panel_.device_controls(), &DeviceControls::refresh_wanted, this,
            &RunController::find_devices);
    connect(&panel_.isovalue_controls(), &IsovalueControls::field_wanted, this,
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

void RunController::start(std::shared_ptr<Opened> volume, const std::vector<run::Setup>& hands) {
    content_.start_run(std::move(volume), hands);
    QStringList names;
    for (const run::Setup& hand : hands) names << QString::fromStdString(run::text_of(hand.device));
    QString words = names.size() == 1 ? tr("Felt through the device %1").arg(names.front())
                                      : tr("Felt through the devices %1").arg(names.join(", "));
    for (const std::string& sentence : content_.live()->privileges()) {
        words += "; " + QString::fromStdString(sentence);
    }
    messages_.show_done(words);
    show_devices();
    Q_EMIT device_changed();
}

void RunController::restore(const RendererSettings& settings, bool in_place) {
    const auto send = [this](const Command& command) { content_.effect().request(command); };
    if (!settings.tool) send(command::UseTool{nullptr});  // beside one, other things are refused
    send(settings.force);
    send(settings.proxy.friction);
    send(settings.penetrability);
    if (settings.layers && !lack_labels(settings.layers)) {
        send(command::UseLayers{settings.layers});
    }
    if (settings.tool) send(command::UseTool{settings.tool});
    if (in_place) send(settings.transform);
    send(command::Forces{settings.forces_on});
    Q_EMIT content_.run_changed();
}

bool RunController::is_tool_file(const QString& path) {
    return io::names_a_mesh(path.toStdString());
}

void RunController::ask_tool() {
    if (!content_.live()) return;
    const QString path = ask_open_tool_name(messages_.window());
    if (!path.isEmpty()) open_tool(path);
}

void RunController::open_tool(const QString& path) {
    messages_.forget();
    if (!content_.live()) {
        return messages_.show_problem(
            tr("%1: this is a tool: open a volume first, and feel it, then open the tool")
                .arg(short_name(path)));
    }
    remember_folder(path);
    const auto read = std::make_shared<io::ToolSpec>();
    reader_.start(
        tr("Reading the tool"),
        [read, path](const io::Progress& progress) {
            *read = io::tool_spec_from(path.toStdString(), progress);
        },
        [this, read, path] {
            if (content_.live()) panel_.tool_controls().add(short_name(path), *read);
        });
}

void RunController::find_devices() {
    if (search_.busy()) return;
    auto found = std::make_shared<std::vector<devices::DeviceFinding>>();
    search_.start(
        tr("Looking for devices"),
        [found](const io::Progress& progress) { *found = devices::find_devices(progress); },
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
            // The recording of two goes on with the other hand.
            const bool recorded =
                content_.hands() == 1 && live->recording() && live->recording()->ticks() > 0;
            content_.use_device(device);
            if (recorded) messages_.show_done(tr("Recorded up to the other device"));
            Q_EMIT device_changed();
        }
        const auto other = static_cast<std::size_t>(content_.hand() - 2);
        (content_.hand() == 1 ? request_.setup.device : request_.others.at(other)) = device;
    });
    show_devices();
}

void RunController::add_hand(const QString& option) {
    messages_.guarded([&] {
        const devices::DeviceChoice device = devices::parse_device(option.toStdString());
        if (!content_.live() || content_.hands() == most_hands) return;
        content_.add_hand(device);
        request_.others.push_back(device);
        Q_EMIT device_changed();
    });
}

void RunController::remove_hand() {
    if (!content_.live() || content_.hands() == 1) return;
    auto& others = request_.others;
    if (content_.hand() == 1) request_.setup.device = others.front();
    others.clear();
    content_.remove_hand();
}

/// The brush is that of all hands: it stays as it is.
void RunController::choose_hand(int hand) {
    BrushControls& brush = panel_.brush_controls();
    const BrushChoice choice = brush.choice();
    content_.choose_hand(hand);
    if (!choice.on) return;
    brush.set_choice(choice);
    Q_EMIT brush.changed(choice);
}

void RunController::choose_next_hand() {
    if (content_.hands() < 2) return;
    choose_hand(content_.hand() % content_.hands() + 1);
    messages_.show_done(tr("The panel shows the settings of hand %1").arg(content_.hand()));
}

void RunController::show_hands() {
    std::vector<HandSwitch::Hand> hands;
    for (int hand = 1; hand <= content_.hands(); ++hand) {
        const run::Run* live = content_.live(hand);
        std::string device = live ? live->device().name : content_.playback(hand)->head().device;
        device.resize(std::min(device.size(), device.find(" (")));  // without the model
        hands.push_back({QString::fromStdString(device),
                         QString::fromStdString(live ? live->device_problem() : std::string())});
    }
    panel_.hand_switch().show_hands(hands, content_.hand());
    panel_.device_controls().set_hands(content_.hands());
}

void RunController::use_field(Solid solid, Interpolation interpolation) {
    if (!content_.live()) return;
    const Field& now = content_.live()->field();
    if (now.solid() == solid && now.interpolation() == interpolation) return;
    messages_.guarded([&] { content_.use_field(solid, interpolation); });
}

void RunController::use_buttons(const run::Buttons& buttons) {
    if (!content_.live()) return;
    const auto use = [&] {
        content_.use_buttons(buttons);
        request_.setup.buttons = buttons;
    };
    if (!messages_.guarded(use)) {
        panel_.device_controls().set_buttons(content_.live()->setup().buttons);
    }
}

void RunController::observe(const Snapshot& now) {
    const run::Run* live = content_.live();
    if (!live) return;
    show_hands();
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
