// palpate replay: renders a recorded motion of the hand offline, always with the same result; or
// validates a recording.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "apps/options/render_options.hpp"
#include "apps/options/source_options.hpp"
#include "apps/options/words.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/offline_summary.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/progress.hpp"
#include "io/recording/settings_json.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/trace.hpp"
#include "palpate/run/replay.hpp"

namespace palpate::app {
namespace {

struct ReplayOptions {
    SourceOptions source;
    run::FieldSetup field;
    RenderOptions render;
    std::string trajectory, output, path, poses;
    bool json = false, validate = false, live = false, wait = false;
    std::string recorded_volume;
};

void print_hand(const run::ValidatedHand& hand, const std::string& recording) {
    const auto count = [](std::int64_t number, const char* thing) {
        return counted(static_cast<std::uint64_t>(number), thing);
    };
    fmt::print("{}: {}{} and {}, rendered again, are the same bit for bit\n", recording, hand.words,
               count(hand.ticks, "tick"), count(hand.commands, "command"));
    if (hand.lost > 0) {
        fmt::print("the recording lost {} while it was made\n", count(hand.lost, "event"));
    }
    if (!hand.complete) {
        fmt::print("the recording was cut off before its end: the ticks after {} are missing\n",
                   hand.ticks - 1);
    }
    if (!hand.has_checksums) {
        fmt::print(
            "an earlier version made it, without checksums: whether something was removed from it "
            "cannot be known\n");
    }
}

/// `volume` is used instead of the name in the recording where it is not empty.
void validate(const std::string& recording, const std::string& volume, bool quiet) {
    const std::string text = io::read_text(recording, stop_if_interrupted);
    const io::RecordingReader reader(text, recording);
    const run::LoadedVolume loaded =
        load_for_terminal(run::recorded_source(reader.head(), recording, volume), quiet);
    std::vector<run::ValidatedHand> hands;
    {
        ProgressBar bar("validating", quiet);
        hands = run::validate(text, recording, loaded, [&](double part) { bar.at(part); });
    }
    if (quiet) return;
    for (const run::ValidatedHand& hand : hands) print_hand(hand, recording);
}

/// A recording contains its own settings.
void refuse_other_options(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        const bool known = name == "VOLUME" || name == "--validate" || name == "--volume" ||
                           name == "-q,--quiet" || name == "--quiet";
        if (option->count() > 0 && !known) {
            throw std::invalid_argument(
                name +
                " does nothing with --validate, which takes the recording in place of VOLUME");
        }
    }
}

/// Waits until so many seconds have passed since its first call. Throws Interrupted.
auto real_time() {
    using Clock = std::chrono::steady_clock;
    return [begin = std::optional<Clock::time_point>{}](double seconds) mutable {
        using Seconds = std::chrono::duration<double>;
        constexpr Seconds longest{0.05};  // until Ctrl-C is heard
        if (!begin) begin = Clock::now();
        for (;;) {
            stop_if_interrupted();
            const auto now = Clock::now();
            const Seconds left = Seconds(seconds) - (now - *begin);
            if (!(left.count() > 0)) return now;
            std::this_thread::sleep_for(std::min(left, longest));
        }
    };
}

/// Throws std::invalid_argument, saying what is missing or does not go together.
void check(const ReplayOptions& options) {
    if (!options.recorded_volume.empty()) {
        throw std::invalid_argument("--volume is for --validate");
    }
    if (options.trajectory.empty())
        throw std::invalid_argument("--trajectory is required (see palpate replay --help)");
    if (options.output.empty())
        throw std::invalid_argument("--output is required (see palpate replay --help)");
    if (options.live && options.wait) {
        throw std::invalid_argument("--live and --wait cannot be given together");
    }
}

void replay(const ReplayOptions& options) {
    if (options.validate) {
        return validate(options.source.name(), options.recorded_volume, options.source.quiet);
    }
    check(options);
    std::vector<std::string> inputs = options.render.inputs();
    inputs.insert(inputs.end(), {options.source.name(), options.trajectory});
    check_outputs(inputs, {options.output, options.path, options.poses});
    const bool table_on_standard_output = is_standard_output(options.output) ||
                                          is_standard_output(options.path) ||
                                          is_standard_output(options.poses);
    if (options.json && table_on_standard_output) {
        throw std::invalid_argument(
            "--json and a table would both go to standard output: give the table a file");
    }
    const io::Trajectory trajectory = io::parse_trajectory(
        io::read_text(options.trajectory, stop_if_interrupted), options.trajectory);
    const run::LoadedVolume loaded = load_for_terminal(options.source);
    const Field field = run::make_field(run::start_samples(loaded), options.field,
                                        options.render.given.method.method);
    const run::RenderSetup render = options.render.setup_in(loaded);
    const double isovalue = required_isovalue(loaded, field, options.field, render);
    Renderer renderer = make_renderer(
        field, isovalue, run::offline_settings(render, field, isovalue, stop_if_interrupted));

    const bool has_tool = renderer.settings.tool != nullptr;
    io::TraceWriter trace(options.output, {},
                          run::trace_extras(renderer.settings, loaded.streamed.has_value()));
    std::optional<io::PathWriter> path;
    if (!options.path.empty()) path.emplace(options.path);
    std::optional<io::PosesWriter> poses;
    if (!options.poses.empty()) {
        if (!has_tool) throw std::invalid_argument("--poses does nothing without --tool");
        poses.emplace(options.poses);
    }
    ProgressBar bar("replaying", options.source.quiet);
    run::OfflineSinks sinks;
    sinks.change = options.live
                       ? run::keep_pace(loaded, trajectory, real_time())
                       : run::wait_for_bricks(loaded, trajectory, [] { stop_if_interrupted(); });
    sinks.row = [&](const io::TraceRow& row) { trace.add(row); };
    if (path) sinks.corner = [&](std::int64_t tick, const Vec3& p) { path->add(tick, p); };
    if (poses) sinks.pose = [&](std::int64_t tick, const Pose& p) { poses->add(tick, p); };
    sinks.progress = [&](double fraction) { bar.at(fraction); };
    const run::OfflineSummary summary = run::render_offline(renderer, trajectory, sinks);
    stop_if_interrupted();
    std::vector<io::PendingFile*> files{&trace.file()};
    if (path) files.push_back(&path->file());
    if (poses) files.push_back(&poses->file());
    io::PendingFile::commit_together(files);
    if (options.json) {
        nlohmann::ordered_json json = summary_json(summary);
        json["settings"] = io::to_json(renderer.settings);
        print_json(json);
    } else if (!options.source.quiet && !table_on_standard_output) {
        fmt::print("{}", summary_text(summary));
    }
}

}  // namespace

void add_replay(CLI::App& app) {
    auto options = std::make_shared<ReplayOptions>();
    CLI::App* command = app.add_subcommand("replay", "Render a recorded motion of the hand");
    command->footer(
        "The trajectory is CSV with columns t,x,y,z (s, mm in the volume's physical space), and "
        "for a tool its orientation qw,qx,qy,qz. A trace works, too.\nThe ramp and the limit on "
        "the change of force, which a live session has, are "
        "off unless asked for.\n\n"
        "Example:\n  palpate replay head.nrrd --trajectory hand.csv --isovalue 34.5 --output "
        "trace.csv --path path.csv\n  palpate replay session.csv --validate");
    options->render.given.force.ramp = 0;
    options->render.given.force.rate_limit = std::numeric_limits<double>::infinity();
    options->source.add_to(*command);
    const auto table = [&](const char* name, std::string& file, const char* help) {
        command->add_option(name, file, help)->type_name("FILE.csv");
    };
    table("--trajectory", options->trajectory, "Motion of the hand");
    table("-o,--output", options->output, "Trace to write; - for standard output");
    table("--path", options->path, "Path of the SCP to write");
    table("--poses", options->poses, "Poses of a tool's proxy to write");
    add_field_options(*command, options->field);
    options->render.add_to(*command, options->source.memory);
    command->add_flag("--live", options->live,
                      "Render in real time and, where samples of a store are missing, hold the "
                      "proxy");
    command->add_flag("--wait", options->wait,
                      "Wait for all samples before each tick, the default");
    command->add_flag("--validate", options->validate,
                      "Render the recording that is given as VOLUME again and compare every tick");
    command
        ->add_option("--volume", options->recorded_volume,
                     "The volume of the recording, if it is no longer where it was")
        ->type_name("VOLUME");
    command->add_flag("--json", options->json, "Print the summary as JSON");
    command->callback([options, command] {
        if (options->validate) refuse_other_options(*command);
        replay(*options);
    });
}

}  // namespace palpate::app
