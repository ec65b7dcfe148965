// palpate demo: a simulated hand explores a volume, without any argument; leaves a picture, a
// figure, the trace and a report in a folder.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <memory>

#include "apps/options/render_options.hpp"
#include "apps/options/source_options.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/demo_changing.hpp"
#include "apps/palpate/demo_parts.hpp"
#include "apps/palpate/offline_summary.hpp"
#include "apps/palpate/progress.hpp"
#include "apps/palpate/result_folder.hpp"
#include "evaluation/html.hpp"
#include "palpate/io/error.hpp"
#include "palpate/io/sample_volume.hpp"
#include "palpate/scenes/motions.hpp"
#include "pictures/levels.hpp"
#include "pictures/picture.hpp"
#include "pictures/view.hpp"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

struct DemoOptions {
    SourceOptions source;
    run::FieldSetup field;
    RenderOptions render;
    std::string motion = "explore";
    scenes::MotionSettings hand;
    int picture_width = 900;  ///< [pixels]
    std::string output = "palpate-demo";
};

struct Demo {
    run::LoadedVolume loaded;
    Field field;
    double isovalue;
    io::Trajectory trajectory;
    std::vector<io::TraceRow> rows;
    run::OfflineSummary summary;
};

/// Renders the motion; writes trajectory, trace and path to files.
void feel(Demo& demo, const DemoOptions& options, const fs::path& folder) {
    Renderer renderer =
        make_renderer(demo.field, demo.isovalue,
                      run::offline_settings(options.render.setup(), demo.field, demo.isovalue));
    write_trajectory(demo.trajectory, folder / "trajectory.csv");
    io::TraceWriter trace(folder / "trace.csv");
    io::PathWriter path(folder / "path.csv");
    ProgressBar bar("feeling", options.source.quiet);
    demo.rows.reserve(demo.trajectory.time.size());
    run::OfflineSinks sinks;
    sinks.row = [&](const io::TraceRow& row) {
        trace.add(row);
        demo.rows.push_back(row);
    };
    sinks.corner = [&](std::int64_t tick, const Vec3& p) { path.add(tick, p); };
    sinks.progress = [&](double fraction) { bar.at(fraction); };
    demo.summary = run::render_offline(renderer, demo.trajectory, sinks);
    trace.commit();
    path.commit();
}

/// Where the hand touched, on average; NaN if it never did.
Vec3 mean_contact(const std::vector<io::TraceRow>& rows) {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (const io::TraceRow& row : rows) {
        if (row.constrained) sum += row.scp;
        count += row.constrained;
    }
    return sum / count;
}

/// The isosurface with the trajectories of hand and proxy. Returns why there is no picture; the
/// demo goes on without it. Empty if it worked.
std::string draw(const Demo& demo, int width, bool quiet, const fs::path& path) {
    pictures::PictureScene scene;
    scene.width = width;
    scene.height = std::max(width * 4 / 5, 16);
    scene.title = demo.loaded.name;
    std::vector<Vec3> hip, scp;
    std::vector<bool> constrained;
    for (const io::TraceRow& row : demo.rows) {
        hip.push_back(row.hip);
        scp.push_back(row.scp);
        constrained.push_back(row.constrained);
    }
    {
        ProgressBar bar("extracting", quiet);
        pictures::add_levels(scene, demo.field, std::array{demo.isovalue},
                             [&](double fraction) { bar.at(fraction); });
    }
    const Vec3 contact = mean_contact(demo.rows);
    const Geometry& geometry = demo.field.geometry();
    const Vec3 towards =
        contact.allFinite() ? Vec3(contact - physical_centre(geometry)) : Vec3(Vec3::Zero());
    pictures::frame(scene, pictures::natural_view(geometry, towards));
    pictures::add_way(scene, hip, scp, constrained);
    pictures::DrawOptions options;
    options.waiting = [] { stop_if_interrupted(); };
    try {
        pictures::draw_picture(scene, path, options);
    } catch (const io::OutputError& e) {
        stop_if_interrupted();  // Ctrl-C ends the helper too, which is not its failure
        return e.what();
    }
    return {};
}

void write_report(const Demo& demo, const DemoOptions& options, bool drawn, bool plotted,
                  const fs::path& path) {
    const Geometry& g = demo.field.geometry();
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Palpate demo</title>\n"
        "<style>body{{font-family:sans-serif;max-width:60em;margin:2em auto}}img{{max-width:100%}}"
        "</style>\n<h1>Palpate demo</h1>\n"
        "<p>A simulated hand ({}, {:g} s, {:g} mm/s, {:g} mm deep, {:g} Hz) felt the surface at "
        "isovalue {:g} of <b>{}</b> ({} x {} x {} samples of {}).</p>\n",
        options.motion, options.hand.duration_s, options.hand.speed_mm_s, options.hand.depth_mm,
        options.hand.rate_hz, demo.isovalue, evaluation::html_text(demo.loaded.name), g.size[0],
        g.size[1], g.size[2], name_of(demo.loaded.volume.type()));
    html += fmt::format("<pre>{}</pre>\n", summary_text(demo.summary));
    if (drawn) {
        html +=
            "<p><img src=\"surface.png\" alt=\"The isosurface with the trajectory of the "
            "hand\"><br>"
            "Blue: the hand (HIP). Vermilion: the proxy (SCP) in contact. Fainter where it is "
            "behind "
            "the surface.</p>\n";
    }
    if (plotted) {
        html += "<p><img src=\"session.png\" alt=\"Depth, force and density over time\"></p>\n";
    }
    html +=
        "<p>Data: <a href=\"trajectory.csv\">trajectory.csv</a> (the hand), <a "
        "href=\"trace.csv\">trace.csv</a> (a row a tick), <a href=\"path.csv\">path.csv</a> (the "
        "path of the SCP).</p>\n</html>\n";
    io::PendingFile file(path);
    file.write(html);
    file.commit();
}

void run_demo(const DemoOptions& options) {
    run::LoadedVolume loaded = load_for_terminal(options.source);
    const Field field = run::make_field(loaded.volume, options.field);
    const double isovalue = suggested_isovalue(loaded, field, options.field);
    Demo demo{std::move(loaded), field, isovalue, {}, {}, {}};
    demo.trajectory =
        trajectory_of(scenes::make_motion(options.motion, field, isovalue, options.hand));
    ResultFolder results(options.output);
    const fs::path& folder = results.part();
    feel(demo, options, folder);
    const std::string no_picture =
        draw(demo, options.picture_width, options.source.quiet, folder / "surface.png");
    if (!no_picture.empty() && !options.source.quiet) {
        fmt::print(stderr, "palpate: note: {}\n", no_picture);
    }
    const bool plotted = plot_trace(folder, folder / "session.png", demo.rows.size()) &&
                         plot_trace(folder, folder / "session.svg", demo.rows.size());
    stop_if_interrupted();
    write_report(demo, options, no_picture.empty(), plotted, folder / "report.html");
    results.complete();
    if (options.source.quiet) return;
    fmt::print("A simulated hand felt {} at isovalue {:g}.\n{}", demo.loaded.name, demo.isovalue,
               summary_text(demo.summary));
    if (!plotted) fmt::print("No figure over time: gnuplot is not installed.\n");
    fmt::print("Results: {} (open report.html)\n", options.output);
}

}  // namespace

void add_demo(CLI::App& app) {
    auto options = std::make_shared<DemoOptions>();
    CLI::App* command =
        app.add_subcommand("demo", "A simulated hand explores a volume; pictures and a report");
    command->footer(
        "Examples:\n  palpate demo\n  palpate demo lobster.nrrd --isovalue 35 --motion circle");
    options->source.add_to(*command, true);
    add_field_options(*command, options->field);
    options->render.add_to(*command);
    add_motion_options(*command, options->motion, options->hand);
    command->add_option("--speed", options->hand.speed_mm_s, "Speed of the hand [mm/s]")
        ->capture_default_str();
    command->add_option("--depth", options->hand.depth_mm, "How deep the hand presses [mm]")
        ->capture_default_str();
    command->add_option("--seed", options->hand.seed, "Seed of the hand's motion")
        ->check(flaw_in_count)
        ->capture_default_str();
    command->add_option("--picture", options->picture_width, "Width of the picture [pixels]")
        ->check(CLI::Range(16, 8192))
        ->capture_default_str();
    command->add_option("-o,--output", options->output, "Folder for the results")
        ->capture_default_str();
    add_demo_sculpt(*command);
    add_demo_beating(*command);
    command->callback([options, command] {
        if (!command->get_subcommands().empty()) return;  // it has done its own
        options->hand.rate_hz = options->render.given.rate;
        if (options->source.name().empty()) {
            options->source.volume() = io::sample_volume_path().string();
            if (command->count("--seed") == 0) options->hand.seed = 2;  // over the face
        }
        run_demo(*options);
    });
}

}  // namespace palpate::app
