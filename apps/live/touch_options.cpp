// From options to a session.
#include "apps/live/touch_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <stdexcept>
#include <thread>

#include "io/number.hpp"

namespace palpate::app {
namespace {

constexpr std::array facings{"anterior", "posterior", "left", "right", "superior", "inferior"};
/// [N] Forces of a live session begin when the wanted one is below this: a tenth of what the
/// smallest devices give.
constexpr double start_below = 0.3;

Facing facing_named(const std::string& name) {
    return static_cast<Facing>(std::ranges::find(facings, name) - facings.begin());
}

/// The bit of a button that is named by its number, from 1.
std::uint32_t button(const std::string& option, const std::string& text, int buttons) {
    if (text == "none") return 0;
    if (text == "auto") return buttons == 0 ? 0 : buttons == 1 ? 1U : 2U;
    const auto number = io::number_from<int>(text);
    if (!number || *number < 1 || *number > 32) {
        throw std::invalid_argument(option + " " + text + ": a button's number from 1, or none");
    }
    if (*number > buttons) {
        throw std::invalid_argument(
            fmt::format("{} {}: the device has {} buttons", option, text, buttons));
    }
    return std::uint32_t{1} << (*number - 1);
}

DeviceTransform transform_for(const Field& field, const DeviceInfo& info,
                              const TouchOptions& options) {
    DeviceTransform transform = fit_workspace(field.geometry(), info, facing_named(options.facing));
    if (!options.scale_given) return transform;
    const Vec3 middle = 0.5 * (info.workspace_low + info.workspace_high);
    transform.translation +=
        (transform.scale - options.render.scale) * (transform.rotation * middle);
    transform.scale = options.render.scale;
    return transform;
}

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    std::array<char, 32> text{};
    std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text.data();
}

}  // namespace

void TouchOptions::add_to(CLI::App& command, For purpose) {
    volume.add_to(command, purpose == For::view);
    command
        .add_option("-d,--device", device,
                    "Device and its options, NAME[:KEY=VALUE,...]; palpate devices lists them")
        ->capture_default_str();
    command.add_option("--facing", facing, "Side of the body that faces you")
        ->check(CLI::IsMember(std::vector<std::string>(facings.begin(), facings.end())))
        ->capture_default_str();
    command.add_option(
        "--clutch", clutch,
        "Button that holds the volume to the hand: 1, 2, ... or none (2, or 1 of 1)");
    command.add_option("--dead-man", deadman, "Button without which there is no force (none)");
    CLI::Option* file =
        command.add_option(purpose == For::record ? "-o,--output" : "--record", record,
                           "Recording to write (CSV; never replaces a file)");
    if (purpose == For::record) file->required();
    if (purpose != For::view) add_script_options(command);
    add_data_options(command);
    field.add_to(command);
    render.force.start_below = start_below;
    render.add_to(command);
    command.get_option("--scale")->default_str("fits the device");
    command.get_option("--force-limit")->default_str("the device's");
    command.get_option("--stiffness")->default_str("0.5, or what the device is rated for");
    command.get_option("--step-budget")->default_str("4096, less above 1 kHz");
    command.add_flag("--normal-priority", normal_priority, "Do not ask for real-time priority");
}

void TouchOptions::add_script_options(CLI::App& command) {
    command.add_option("--commands", commands,
                       "File of commands, a line each: SECONDS COMMAND, as in 1.5 isovalue 300");
    command
        .add_option("--seconds", seconds, "End after so long (default: when the hand has finished)")
        ->check(CLI::PositiveNumber);
    command.add_option("--brush", brush,
                       "Brush that follows the proxy from the start: 'KIND RADIUS [RATE [VALUE]]', "
                       "KIND carve, add, smooth or paint, RADIUS [mm], RATE [1/s] or inf");
    command.add_option("--save", save, "File for the volume as it is at the end, edits included");
    command.add_flag("--json", json, "Print the report as JSON");
}

void TouchOptions::add_data_options(CLI::App& command) {
    command
        .add_option("--playback", playback,
                    "Speed at which a sequence is played from the start; 0: it stands still")
        ->check(CLI::Range(-1000.0, 1000.0))
        ->capture_default_str();
    command.add_flag("--once", once, "A sequence stops at its end instead of beginning anew");
    command
        .add_option("--sequence-memory", sequence_memory_mb,
                    "Most memory that frames of a sequence may take [MB]")
        ->check(CLI::Range(1, 1 << 20))
        ->capture_default_str();
}

io::LoaderSettings TouchOptions::loader() const {
    return {std::uint64_t(sequence_memory_mb) << 20, !once};
}

void TouchOptions::finish(const CLI::App& command) {
    limit_given = command.count("--force-limit") > 0;
    stiffness_given = command.count("--stiffness") > 0;
    budget_given = command.count("--step-budget") > 0;
    scale_given = command.count("--scale") > 0;
    device_given = command.count("--device") > 0;
}

LiveScene make_scene(LoadedVolume loaded, const TouchOptions& options) {
    Field field = make_field(loaded, options.field);
    const double isovalue = suggested_isovalue_of(loaded, field, options.field);
    const double rate = options.render.rate;
    if (!(rate >= 250 && rate <= 8000)) {
        throw std::invalid_argument(
            fmt::format("--rate {}: a live session runs at 250 to 8000 Hz", rate));
    }
    auto device = devices::open_device(devices::parse_device(options.device),
                                       {field, isovalue, rate, [&](const DeviceInfo& info) {
                                            return transform_for(field, info, options);
                                        }});
    const DeviceInfo info = device->info();
    RenderOptions render = options.render;
    if (!options.limit_given) render.force.limit = info.limits.maximum_force;
    if (!options.stiffness_given) {
        render.force.stiffness = std::min(render.force.stiffness, info.stiffness);
    }
    if (!options.budget_given) {
        // Its worst case is half a tick at 1 kHz, whatever the rate.
        render.step_budget = static_cast<int>(render.step_budget * std::min(1.0, 1000 / rate));
    }
    // The slower of device and loop is what renders the spring.
    render.rate = std::min(rate, info.limits.rate);
    RendererSettings settings = render_settings(render, field, isovalue, info.limits);
    settings.transform = transform_for(field, info, options);
    Session session{make_renderer(field, isovalue, settings), {}};
    session.settings.clutch_buttons = button("--clutch", options.clutch, info.buttons);
    session.settings.deadman_buttons = button("--dead-man", options.deadman, info.buttons);
    if (session.settings.clutch_buttons & session.settings.deadman_buttons) {
        throw std::invalid_argument("clutch and dead-man switch are the same button: name another");
    }
    return {std::move(loaded), std::move(field), isovalue, std::move(device), info,
            std::move(session)};
}

void tell(io::RecordingWriter& recording, const std::vector<Command>& commands) {
    for (const Command& command : commands) {
        while (recording.problem().empty() && !recording.queue().push(command)) {
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }
}

io::RecordingHead recording_head(const Session& session, const DeviceInfo& device,
                                 const TouchOptions& options) {
    const Field& field = session.renderer.field;
    io::RecordingHead head;
    head.version = PALPATE_VERSION;
    head.begun = utc_now();
    head.volume = io::identify(field.volume(), to_names(options.volume));
    head.solid = field.solid();
    head.background = field.background();
    head.isovalue = session.renderer.proxy.isovalue;
    head.device = device.name + " (" + device.model + ")";
    head.rate = options.render.rate;
    head.method = options.render.method;
    head.settings = session.renderer.settings;
    head.session = session.settings;
    return head;
}

}  // namespace palpate::app
