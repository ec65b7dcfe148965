// palpate replay: a recorded motion of the hand over a volume, off line, deterministic.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "apps/live/render_options.hpp"
#include "apps/live/volume_options.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/offline.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/progress.hpp"
#include "apps/palpate/validate.hpp"

namespace palpate::app {
namespace {

struct ReplayOptions {
    VolumeOptions volume;
    FieldOptions field;
    RenderOptions render;
    std::string trajectory, output, path;
    bool json = false, validate = false;
    std::string recorded_volume;
};

/// A recording says itself how it was felt.
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

void replay(const ReplayOptions& options) {
    if (options.validate) {
        return validate(options.volume.volume, options.recorded_volume, options.volume.quiet);
    }
    if (!options.recorded_volume.empty()) {
        throw std::invalid_argument("--volume is for --validate");
    }
    if (options.trajectory.empty()) throw std::invalid_argument("--trajectory is required");
    if (options.output.empty()) throw std::invalid_argument("--output is required");
    check_outputs({options.volume.volume, options.trajectory}, {options.output, options.path});
    const bool table_on_standard_output =
        is_standard_output(options.output) || is_standard_output(options.path);
    if (options.json && table_on_standard_output) {
        throw std::invalid_argument(
            "--json and a table would both go to standard output: give the table a file");
    }
    const io::Trajectory trajectory = io::read_trajectory(options.trajectory);
    const LoadedVolume loaded = load_for_terminal(options.volume);
    const Field field = make_field(loaded, options.field);
    const double isovalue = isovalue_of(loaded, field, options.field);
    RendererSettings settings = render_settings(options.render, field, isovalue);
    // No device is at hand, and a recording has no pauses: only the limit asked for holds.
    settings.device.maximum_force = std::max(settings.device.maximum_force, settings.force.limit);
    settings.force.stale_after = std::numeric_limits<double>::infinity();
    Renderer renderer = make_renderer(field, isovalue, settings);

    io::TraceWriter trace(options.output);
    std::optional<io::PathWriter> path;
    if (!options.path.empty()) path.emplace(options.path);
    ProgressBar bar("replaying", options.volume.quiet);
    OfflineSinks sinks;
    sinks.row = [&](const io::TraceRow& row) { trace.add(row); };
    if (path) sinks.corner = [&](std::int64_t tick, const Vec3& p) { path->add(tick, p); };
    sinks.progress = [&](double fraction) { bar.at(fraction); };
    const OfflineSummary summary = render_offline(renderer, trajectory, sinks);
    stop_if_interrupted();
    // A stream may fail, a rename hardly: first the stream, so that no file stays if it does.
    const bool path_first = path && is_stream(options.path);
    if (path_first) path->commit();
    trace.commit();
    if (path && !path_first) path->commit();
    if (options.json) {
        fmt::print("{}", summary_json(summary));
    } else if (!options.volume.quiet && !table_on_standard_output) {
        fmt::print("{}", summary_text(summary));
    }
}

}  // namespace

void add_replay(CLI::App& app) {
    auto options = std::make_shared<ReplayOptions>();
    CLI::App* command = app.add_subcommand("replay", "Render a recorded motion of the hand");
    command->footer(
        "The trajectory is CSV with columns t,x,y,z (s, mm in the volume's physical space); a "
        "trace "
        "serves too.\nThe ramp and the limit on the change of force, which a live session has, are "
        "off unless asked for.\n\n"
        "Example:\n  palpate replay head.nrrd --trajectory hand.csv --isovalue 500 --output "
        "trace.csv --path path.csv\n  palpate replay session.csv --validate");
    options->render.force.ramp = 0;
    options->render.force.rate_limit = std::numeric_limits<double>::infinity();
    options->volume.add_to(*command);
    command->add_option("--trajectory", options->trajectory, "Motion of the hand (CSV)");
    command->add_option("-o,--output", options->output, "Trace to write (CSV; - for standard out)");
    command->add_option("--path", options->path, "Path of the SCP to write (CSV)");
    options->field.add_to(*command);
    options->render.add_to(*command);
    command->add_flag("--validate", options->validate,
                      "Render the recording that is given as VOLUME again and compare every tick");
    command->add_option("--volume", options->recorded_volume,
                        "The volume of the recording, if it is no longer where it was");
    command->add_flag("--json", options->json, "Print the summary as JSON");
    command->callback([options, command] {
        if (options->validate) refuse_other_options(*command);
        replay(*options);
    });
}

}  // namespace palpate::app
