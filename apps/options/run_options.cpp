// Options of device, scripts and data for a live run.
#include "apps/options/run_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "apps/options/values.hpp"
#include "io/system/number.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/io/written_formats.hpp"
#include "palpate/names.hpp"

namespace palpate::app {
namespace {

std::vector<devices::DeviceChoice> choices_from(const std::vector<std::string>& texts) {
    std::vector<devices::DeviceChoice> choices;
    for (const std::string& text : texts) choices.push_back(devices::parse_device(text));
    return choices;
}

}  // namespace

void RunOptions::add_to(CLI::App& command, For purpose) {
    source.add_to(command, SourceOptions::For::touching, purpose == For::view);
    add_device_options(command);
    CLI::Option* file = command
                            .add_option(purpose == For::record ? "-o,--output" : "--record", record,
                                        "Recording to write (never replaces a file)")
                            ->type_name("FILE.csv");
    if (purpose == For::record) file->required();
    if (purpose != For::view) add_script_options(command);
    add_data_options(command);
    add_field_options(command, given.field);
    render.given.force.start_below = run::live_start_below;
    render.add_to(command, source.memory);
    command.get_option("--rate")->description(
        "Updates of proxy and force per second (default: 1000, or 250 with a device that renders "
        "no force)");
    command.get_option("--scale")->default_str("fits the device");
    command.get_option("--force-limit")->default_str("the device's");
    command.get_option("--stiffness")->default_str("0.5, or the device's rated stiffness");
    command.get_option("--step-budget")->default_str("4096, less above 1 kHz");
    command.add_flag(
        "--normal-priority", [this](std::int64_t) { given.real_time = false; },
        "Do not ask for real-time priority");
}

void RunOptions::add_device_options(CLI::App& command) {
    command
        .add_option_function<std::vector<std::string>>(
            "-d,--device",
            [this](const std::vector<std::string>& texts) { devices = choices_from(texts); },
            "Device and its options, which palpate devices lists. Give it again to add a hand in "
            "the same volume")
        ->allow_extra_args(false)
        ->type_name(fmt::format("{{{}}}[:KEY=VALUE,...]", fmt::join(devices::device_names(), ",")))
        ->default_str(run::text_of(given.device));
    add_named(command, "--facing", given.facing, "Side of the body that faces you");
    for_each_setting<run::Buttons>([&](const auto& one) {
        const auto choose = [this, one](const std::string& text) {
            given.buttons.*one.member = run::button_from(one.option, text);
            named_buttons.push_back(one.member);
        };
        command.add_option_function<std::string>(
            one.option, choose, fmt::format("{} (default: {})", one.about, one.left_open));
    });
    for_each_setting<SessionSettings>([&](const auto& one) {
        auto& value = given.session.*one.member;
        if constexpr (std::same_as<double&, decltype(value)>) {
            command.add_option(one.option, value, fmt::format("{} [{}]", one.about, one.unit))
                ->default_str(fmt::format("{}", value));
        }
    });
}

void RunOptions::add_script_options(CLI::App& command) {
    command
        .add_option("--commands", commands,
                    "File of commands with their times, one per line: SECONDS COMMAND, for example "
                    "1.5 isovalue 300")
        ->type_name("FILE.txt");
    command
        .add_option("--seconds", seconds,
                    "End after this time [s] (default: when the hand has finished)")
        ->check(above_zero());
    command.add_flag("--unpaced", unpaced,
                     "Do not wait for the clock: compute a session with a simulated or recorded "
                     "hand as fast as possible, in the same way each time");
    command.add_option(
        "--brush", brush,
        "Brush that follows the proxy from the start: 'KIND RADIUS [RATE [VALUE]]'. KIND is carve, "
        "add, smooth or paint. RADIUS is that of a ball [mm], or tool[:BEYOND] for the tool's own "
        "shape and BEYOND mm around it. RATE is in 1/s, or inf");
    command
        .add_option("--save", save,
                    "File for the volume at the end, with its edits, or a folder *.zarr")
        ->type_name(file_of(io::written_extensions()));
    command.add_flag("--json", json, "Print the report as JSON");
}

void RunOptions::add_data_options(CLI::App& command) {
    command
        .add_option("--playback", given.playback.speed,
                    "Speed at which a sequence is played from the start. 0 is paused")
        ->check(from_to(-1000.0, 1000.0))
        ->capture_default_str();
    command.add_flag(
        "--once", [this](std::int64_t) { given.playback.loader.loop = false; },
        "Stop a sequence at its end instead of starting again");
    command
        .add_option_function<int>(
            "--sequence-memory",
            [this](int megabytes) {
                given.playback.loader.memory_bytes = std::uint64_t(megabytes) << 20;
            },
            "Memory limit for the frames of a sequence [MB]")
        ->check(from_to(1, 1 << 20))
        ->default_str(std::to_string(given.playback.loader.memory_bytes >> 20));
}

std::vector<std::string> RunOptions::beside_session() const {
    std::vector<std::string> names = render.named_options();
    for (const char* name : {"--record", "--rate", "--step-budget", "--normal-priority",
                             "--playback", "--once", "--sequence-memory"}) {
        names.emplace_back(name);
    }
    for_each_setting<run::Buttons>([&](const auto& one) { names.emplace_back(one.option); });
    for_each_setting<SessionSettings>([&](const auto& one) { names.emplace_back(one.option); });
    return names;
}

std::vector<run::Setup> RunOptions::setups() const {
    run::Setup setup = given;
    setup.render = render.setup();
    std::vector<run::Setup> setups(std::max<std::size_t>(1, devices.size()), setup);
    for (std::size_t i = 0; i < devices.size(); ++i) setups[i].device = devices[i];
    return setups;
}

}  // namespace palpate::app
