// Renders a demo's motion and writes its files.
#include "apps/palpate/demo_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "apps/options/say.hpp"
#include "apps/options/values.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/demo_figure.hpp"
#include "apps/palpate/offline_summary.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/picture.hpp"
#include "apps/palpate/progress.hpp"
#include "io/system/result_folder.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/output.hpp"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

/// Where a simulated hand finds a surface: the outermost of layers by level, else the level asked
/// for or suggested. Throws std::invalid_argument if nothing is solid there.
double touched_isovalue(const run::LoadedVolume& loaded, const Field& field,
                        const run::FieldSetup& setup, const run::RenderSetup& render) {
    const auto& layers = render.layers;
    const bool has_levels = layers && !layers->layers.by_label && !layers->layers.layers.empty();
    if (has_levels) return required_isovalue(loaded, field, setup, render);
    const double isovalue = run::isovalue_of(loaded, setup);
    const double s = field.sign();
    const Samples& samples = field.samples();
    const double most = s > 0 ? samples.maximum() : samples.minimum();
    if (s * isovalue >= std::max(s * most, s * field.background())) {
        throw std::invalid_argument(run::level_warning(field, isovalue));
    }
    if (layers) warn_of_layers(*layers, loaded);
    warn_of_isovalue(field, isovalue);
    return isovalue;
}

/// The trajectory of the hand as a file that replay reads.
void write_trajectory(const io::Trajectory& trajectory, const fs::path& path) {
    std::string text = "t,x,y,z\n";
    for (std::size_t i = 0; i < trajectory.time.size(); ++i) {
        const Vec3& p = trajectory.position[i];
        text += fmt::format("{},{},{},{}\n", trajectory.time[i], p[0], p[1], p[2]);
    }
    io::write_file(path, text);
}

/// Renders the motion; writes trajectory, trace and path to files.
void feel(Demo& demo, const DemoOptions& options, const fs::path& folder) {
    Renderer renderer = make_renderer(
        demo.field, demo.isovalue, run::offline_settings(demo.render, demo.field, demo.isovalue));
    write_trajectory(demo.trajectory, folder / "trajectory.csv");
    io::TraceWriter trace(folder / "trace.csv", {}, run::trace_extras(renderer.settings));
    std::optional<io::PathWriter> path;
    run::OfflineSinks sinks;
    if (!demo.change) {
        path.emplace(folder / "path.csv");
        sinks.corner = [&](std::int64_t tick, const Vec3& p) { path->add(tick, p); };
    }
    sinks.change = demo.change;
    demo.rows.reserve(demo.trajectory.time.size());
    sinks.row = [&](const io::TraceRow& row) {
        trace.add(row);
        demo.rows.push_back(row);
        if (demo.after) demo.after(renderer, row);
    };
    ProgressBar bar("feeling", options.source.quiet);
    sinks.progress = [&](double fraction) { bar.at(fraction); };
    demo.summary = run::render_offline(renderer, demo.trajectory, sinks);
    trace.commit();
    if (path) path->commit();
}

/// Escapes all markup.
std::string html_text(std::string_view text) {
    std::string html;
    for (const char c : text) {
        html += c == '&'   ? "&amp;"
                : c == '<' ? "&lt;"
                : c == '>' ? "&gt;"
                : c == '"' ? "&quot;"
                           : std::string(1, c);
    }
    return html;
}

std::string image_html(const std::string& file, const std::string& shows,
                       const std::string& legend) {
    return fmt::format("<p><img src=\"{}\" alt=\"{}\">{}</p>\n", file, shows,
                       legend.empty() ? "" : "<br>" + legend);
}

std::string report_html(const Demo& demo, const std::string& images) {
    const Index3& size = demo.field.geometry().size;
    const std::string path =
        demo.change ? "" : ", <a href=\"path.csv\">path.csv</a> (the path of the SCP)";
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Palpate demo</title>\n"
        "<style>body{{font-family:sans-serif;max-width:60em;margin:2em auto}}img{{max-width:100%}}"
        "</style>\n<h1>Palpate demo</h1>\n"
        "<p>{} touched the surface at isovalue {:g} of <b>{}</b> ({} x {} x {} samples of "
        "{}).</p>\n"
        "<pre>{}</pre>\n{}"
        "<p>Data: <a href=\"trajectory.csv\">trajectory.csv</a> (the hand), <a "
        "href=\"trace.csv\">trace.csv</a> (one row per tick){}.</p>\n</html>\n",
        demo.hand, demo.isovalue, html_text(io::without_secrets(demo.loaded.name)), size[0],
        size[1], size[2], name_of(demo.loaded.volume.type()), summary_text(demo.summary), images,
        path);
}

}  // namespace

void add_demo_options(CLI::App& command, DemoOptions& options) {
    options.source.add_to(command, SourceOptions::For::surfaces, true);
    add_field_options(command, options.field);
    options.render.add_to(command, options.source.memory);
    command.option_defaults()->always_capture_default();  // of all that follow
    command.add_option("--depth", options.hand.depth_mm, "Depth below the surface [mm]");
    command.add_option("--picture", options.picture_width, "Width of the picture [pixels]")
        ->check(from_to(16, 8192));
    command.add_option("-o,--output", options.output, "Folder for the results")
        ->type_name("FOLDER");
}

void add_motion_options(CLI::App& command, DemoOptions& options) {
    command.add_option("--motion", options.motion, "Motion of the hand")
        ->check(one_of(scenes::motion_names()));
    command.add_option("--duration", options.hand.duration_s, "Duration of the motion [s]");
}

std::vector<std::string> DemoOptions::all_results() const {
    std::vector<std::string> all{"report.html", "surface.png",    "session.png",
                                 "session.svg", "trajectory.csv", "trace.csv"};
    all.insert(all.end(), results.begin(), results.end());
    return all;
}

Demo load_demo(const DemoOptions& options) {
    std::vector<std::string> inputs = options.render.inputs(), outputs;
    inputs.push_back(options.source.name());
    for (const std::string& name : options.all_results()) {
        outputs.push_back((fs::path(options.output) / name).string());
    }
    refuse_inputs(inputs, outputs);
    run::LoadedVolume loaded = load_whole(options.source);
    const Field field =
        run::make_field(loaded.volume, options.field, options.render.given.method.method);
    run::RenderSetup render = options.render.setup_in(loaded);
    const double isovalue = touched_isovalue(loaded, field, options.field, render);
    return {.loaded = std::move(loaded),
            .field = field,
            .isovalue = isovalue,
            .render = std::move(render)};
}

io::Trajectory motion_of(const Demo& demo, const DemoOptions& options) {
    io::Trajectory trajectory;
    for (const scenes::HandSample& sample :
         scenes::make_motion(options.motion, demo.field, demo.isovalue, options.hand)) {
        trajectory.time.push_back(sample.t);
        trajectory.position.push_back(sample.position);
    }
    return trajectory;
}

pictures::PictureScene scene_of(const Demo& demo, const DemoOptions& options) {
    const int width = options.picture_width;
    return scene_of(demo.loaded, width, std::max(width * 4 / 5, 16));
}

void run_demo(Demo& demo, const DemoOptions& options, const DemoPicture& picture,
              const std::function<void(const fs::path& folder)>& more) {
    const bool quiet = options.source.quiet;
    io::ResultFolder results(options.output, options.all_results());
    bool plotted = false;
    results.make([&](const fs::path& folder) {
        feel(demo, options, folder);
        std::string images;
        try {
            picture.draw(folder);
            images += image_html(picture.file, picture.shows, picture.legend);
        } catch (const io::OutputError& e) {
            if (!quiet) say("palpate: note: {}\n", e.what());
        }
        plotted = plot_over_time(demo.rows, folder);
        if (plotted) images += image_html("session.png", "Depth, force and density over time", "");
        if (more) more(folder);
        stop_if_interrupted();
        io::write_file(folder / "report.html", report_html(demo, images));
    });
    results.complete();
    if (quiet) return;
    fmt::print("{} touched {} at isovalue {:g}.\n{}", demo.hand,
               io::without_secrets(demo.loaded.name), demo.isovalue, summary_text(demo.summary));
    if (!plotted) fmt::print("No figure over time: gnuplot is not installed.\n");
    fmt::print("Results: {} (open report.html)\n", options.output);
}

}  // namespace palpate::app
