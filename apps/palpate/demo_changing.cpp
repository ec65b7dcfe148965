// palpate demo sculpt and palpate demo beating: data that change while a simulated hand feels them,
// as an animation.
#include "apps/palpate/demo_changing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "apps/options/render_options.hpp"
#include "apps/options/source_options.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/demo_parts.hpp"
#include "apps/palpate/offline_summary.hpp"
#include "apps/palpate/progress.hpp"
#include "apps/palpate/result_folder.hpp"
#include "evaluation/html.hpp"
#include "palpate/editor.hpp"
#include "palpate/run/brush.hpp"
#include "palpate/scenes/motions.hpp"
#include "pictures/animation.hpp"
#include "pictures/contact.hpp"
#include "pictures/levels.hpp"
#include "pictures/picture.hpp"
#include "pictures/view.hpp"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

/// [ticks] between two strokes of the brush.
constexpr std::int64_t brush_interval = 4;
/// [mm] Distance from which the hand of `beating` comes.
constexpr double approach = 12;

struct ChangingOptions {
    SourceOptions source;
    run::FieldSetup field;
    RenderOptions render;
    run::HandBrush brush;
    std::string motion = "slide";
    scenes::MotionSettings hand{.duration_s = 4, .depth_mm = 3};
    int beats = 4;
    int pictures = 24;
    int picture_width = 480;  ///< [pixels]
    std::string output;
};

/// A moment of which a picture is made.
struct Image {
    Field field;
    io::TraceRow row;
};

struct ChangingDemo {
    run::LoadedVolume loaded;
    Field field;
    double isovalue;
    std::string what;  ///< in a sentence
    io::Trajectory trajectory;
    std::function<void(Renderer&, std::int64_t tick)> change;
    std::int64_t first_image = 0;             ///< tick of the first picture
    double seconds_per_picture = 0.1;         ///< of the animation
    std::optional<pictures::View> view = {};  ///< nothing: a view of the contact
    std::vector<io::TraceRow> rows = {};
    std::vector<Image> images = {};
    run::OfflineSummary summary = {};
};

/// Renders the motion while the data change.
void feel(ChangingDemo& demo, const ChangingOptions& options, const fs::path& folder) {
    Renderer renderer =
        make_renderer(demo.field, demo.isovalue,
                      run::offline_settings(options.render.setup(), demo.field, demo.isovalue));
    write_trajectory(demo.trajectory, folder / "trajectory.csv");
    io::TraceWriter trace(folder / "trace.csv");
    const auto ticks = static_cast<std::int64_t>(demo.trajectory.time.size());
    const std::int64_t span = ticks - demo.first_image;
    const auto image_tick = [&](std::size_t i) {
        return demo.first_image + span * static_cast<std::int64_t>(i) / options.pictures;
    };
    ProgressBar bar("feeling", options.source.quiet);
    run::OfflineSinks sinks;
    sinks.change = demo.change;
    sinks.row = [&](const io::TraceRow& row) {
        trace.add(row);
        const auto tick = static_cast<std::int64_t>(demo.rows.size());
        demo.rows.push_back(row);
        const bool wanted = demo.images.size() < static_cast<std::size_t>(options.pictures);
        if (wanted && tick >= image_tick(demo.images.size())) {
            demo.images.push_back({renderer.field, row});
        }
    };
    sinks.progress = [&](double fraction) { bar.at(fraction); };
    demo.summary = run::render_offline(renderer, demo.trajectory, sinks);
    trace.commit();
    demo.field = renderer.field;
}

pictures::PictureScene picture_of(const ChangingDemo& demo, const Image& image, int width,
                                  const Vec3& towards) {
    pictures::PictureScene scene;
    scene.width = width;
    scene.height = std::max(width * 4 / 5, 16);
    scene.title = demo.loaded.name;
    pictures::add_levels(scene, image.field, std::array{demo.isovalue});
    // Directed by the grid, not by the surface: that changes from picture to picture.
    pictures::PictureScene grid = scene;
    const SampleBox box = whole_box(image.field.geometry());
    grid.surfaces.clear();
    for (const Index3& corner : {box.low, box.high}) {
        grid.balls.push_back(
            {physical_from_index(image.field.geometry(), corner.cast<double>()), 1, {}, {}});
    }
    pictures::frame(
        grid, demo.view.value_or(pictures::natural_view(image.field.geometry(), towards)), 1.3);
    scene.camera = grid.camera;
    pictures::Contact contact{image.row.scp, image.row.hip, {}};
    if (image.row.force.norm() > 0) contact.force = image.row.force;
    pictures::add_contact(scene, contact);
    return scene;
}

/// The animation and the last of its pictures. Empty if it worked, else why there is none.
std::string draw(const ChangingDemo& demo, const ChangingOptions& options, const fs::path& folder) {
    Vec3 towards = Vec3::Zero();
    for (const Image& image : demo.images) {
        towards += image.row.scp - physical_centre(demo.field.geometry());
    }
    pictures::DrawOptions draw;
    draw.waiting = [] { stop_if_interrupted(); };
    std::vector<std::string> pngs;
    ProgressBar bar("drawing", options.source.quiet);
    try {
        for (const Image& image : demo.images) {
            const auto scene = picture_of(demo, image, options.picture_width, towards);
            pngs.push_back(pictures::png_of(scene, draw));
            bar.at(static_cast<double>(pngs.size()) / static_cast<double>(demo.images.size()));
        }
    } catch (const io::OutputError& e) {
        stop_if_interrupted();  // Ctrl-C ends the helper too, which is not its failure
        return e.what();
    }
    io::PendingFile animation(folder / "animation.png");
    animation.write(pictures::animation_of(pngs, demo.seconds_per_picture));
    animation.commit();
    io::PendingFile last(folder / "surface.png");
    last.write(pngs.back());
    last.commit();
    return {};
}

void write_report(const ChangingDemo& demo, bool drawn, bool plotted, const fs::path& path) {
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Palpate demo</title>\n"
        "<style>body{{font-family:sans-serif;max-width:60em;margin:2em auto}}img{{max-width:100%}}"
        "</style>\n<h1>Palpate demo</h1>\n<p>{} Isovalue {:g} of <b>{}</b>.</p>\n<pre>{}</pre>\n",
        evaluation::html_text(demo.what), demo.isovalue, evaluation::html_text(demo.loaded.name),
        summary_text(demo.summary));
    if (drawn) {
        html +=
            "<p><img src=\"animation.png\" alt=\"The surface while it changes\"><br>Blue: the "
            "hand (HIP). Vermilion: the proxy (SCP). Green: the force.</p>\n";
    }
    if (plotted) {
        html += "<p><img src=\"session.png\" alt=\"Depth, force and density over time\"></p>\n";
    }
    html +=
        "<p>Data: <a href=\"trajectory.csv\">trajectory.csv</a> (the hand), <a "
        "href=\"trace.csv\">trace.csv</a> (a row a tick).</p>\n</html>\n";
    io::PendingFile file(path);
    file.write(html);
    file.commit();
}

/// Feels, draws and reports; `more` adds files of its own to the results.
void run(ChangingDemo& demo, const ChangingOptions& options,
         const std::function<void(const fs::path& folder)>& more = {}) {
    ResultFolder results(options.output);
    const fs::path& folder = results.part();
    feel(demo, options, folder);
    const std::string no_picture = draw(demo, options, folder);
    if (!no_picture.empty() && !options.source.quiet) {
        fmt::print(stderr, "palpate: note: {}\n", no_picture);
    }
    const bool plotted = plot_trace(folder, folder / "session.png", demo.rows.size()) &&
                         plot_trace(folder, folder / "session.svg", demo.rows.size());
    if (more) more(folder);
    stop_if_interrupted();
    write_report(demo, no_picture.empty(), plotted, folder / "report.html");
    results.complete();
    if (options.source.quiet) return;
    fmt::print("{}\n{}", demo.what, summary_text(demo.summary));
    if (!plotted) fmt::print("No figure over time: gnuplot is not installed.\n");
    fmt::print("Results: {} (open report.html)\n", options.output);
}

void sculpt(const ChangingOptions& options) {
    run::check(options.brush);
    run::LoadedVolume loaded = load_for_terminal(options.source);
    const Field field = run::make_field(loaded.volume, options.field);
    const double isovalue = suggested_isovalue(loaded, field, options.field);
    ChangingDemo demo{std::move(loaded), field, isovalue, {}, {}, {}};
    demo.trajectory =
        trajectory_of(scenes::make_motion(options.motion, field, isovalue, options.hand));
    demo.what =
        fmt::format("A simulated hand ({}) with a brush that will {} {:g} mm about the proxy.",
                    options.motion, name_of(options.brush.kind), options.brush.radius);
    Editor editor(field.shared_samples());
    std::optional<Vec3> from;
    const double dt = static_cast<double>(brush_interval) / options.hand.rate_hz;
    demo.change = [&](Renderer& renderer, std::int64_t tick) {
        if (tick % brush_interval != 0) return;
        const Proxy& proxy = renderer.proxy;
        if (proxy.mode == Mode::free) return from.reset();
        const auto stroke = from ? run::stroke_of(options.brush, field, proxy.isovalue, *from,
                                                  proxy.scp_physical, dt)
                                 : std::nullopt;
        from = proxy.scp_physical;
        if (!stroke) return;
        editor.apply(*stroke, EditStep::same);
        field_will_change(renderer.proxy, renderer.field);
        renderer.field.use(editor.samples());
    };
    demo.seconds_per_picture = options.hand.duration_s / options.pictures;
    run(demo, options, [&](const fs::path& folder) {
        io::write_volume(flattened(*editor.samples()), folder / "edited.nrrd");
    });
}

/// Comes to the surface from outside, along x, rests some millimetres deep and stays there.
io::Trajectory resting_hand(const Field& field, double isovalue, double depth, double seconds,
                            double rate) {
    const Geometry& g = field.geometry();
    const Vec3 centre = physical_centre(g);
    const Vec3 out = g.direction.col(0);
    const double reach = 0.5 * g.size[0] * g.spacing[0] + approach;
    const RayHit ray = cast_ray(field, isovalue, centre + reach * out, centre);
    const Vec3 begin = ray.point + approach * out;
    const Vec3 end = ray.point - depth * out;
    constexpr double arrival = 0.6;  // [s]
    io::Trajectory trajectory;
    const auto ticks = static_cast<std::int64_t>((arrival + seconds) * rate);
    for (std::int64_t i = 0; i <= ticks; ++i) {
        const double t = static_cast<double>(i) / rate;
        const double part = std::min(t / arrival, 1.0);
        const double eased = part * part * (3 - 2 * part);
        trajectory.time.push_back(t);
        trajectory.position.push_back(begin + eased * (end - begin));
    }
    return trajectory;
}

std::shared_ptr<const Samples> all_frames(const run::LoadedVolume& loaded, bool quiet) {
    const io::Sequence& sequence = loaded.sequence;
    ProgressBar bar("reading frames", quiet);
    std::vector<Frame> frames{{sequence.times[0], loaded.volume, 0}};
    for (int i = 1; i < sequence.count(); ++i) {
        frames.push_back({sequence.times[std::size_t(i)], io::read_frame(sequence, i), i});
        bar.at(static_cast<double>(i) / sequence.count());
    }
    return std::make_shared<const Samples>(std::move(frames), sequence.period);
}

void beating(const ChangingOptions& options) {
    run::LoadedVolume loaded = load_for_terminal(options.source);
    if (loaded.sequence.count() < 2) {
        throw std::invalid_argument(loaded.name + ": is no sequence: it has one frame only");
    }
    const Field first = run::make_field(loaded.volume, options.field);
    const double isovalue = suggested_isovalue(loaded, first, options.field);
    const Field field(all_frames(loaded, options.source.quiet), first.solid(), first.background());
    const double period = loaded.sequence.period;
    const double begin = loaded.sequence.times.front();
    const double rate = options.hand.rate_hz;
    ChangingDemo demo{std::move(loaded), field, isovalue, {}, {}, {}};
    demo.trajectory =
        resting_hand(field, isovalue, options.hand.depth_mm, options.beats * period, rate);
    demo.what = fmt::format("A hand rests {:g} mm deep in a surface that goes round in {:g} s.",
                            options.hand.depth_mm, period);
    demo.change = [begin, rate](Renderer& renderer, std::int64_t tick) {
        field_will_change(renderer.proxy, renderer.field);
        renderer.field.set_time(begin + static_cast<double>(tick) / rate);
    };
    const auto ticks = static_cast<std::int64_t>(demo.trajectory.time.size());
    demo.first_image = ticks - static_cast<std::int64_t>(period * rate);
    demo.seconds_per_picture = period / options.pictures;
    demo.view = pictures::view_from(25, 15);  // the hand comes from the side
    run(demo, options);
}

void add_options(CLI::App& command, ChangingOptions& options) {
    options.source.add_to(command, true);
    add_field_options(command, options.field);
    options.render.add_to(command);
    command.add_option("--depth", options.hand.depth_mm, "How deep the hand presses [mm]")
        ->capture_default_str();
    command.add_option("--pictures", options.pictures, "How many the animation has")
        ->check(CLI::Range(2, 240))
        ->capture_default_str();
    command.add_option("--picture", options.picture_width, "Width of the pictures [pixels]")
        ->check(CLI::Range(16, 8192))
        ->capture_default_str();
    command.add_option("-o,--output", options.output, "Folder for the results")
        ->capture_default_str();
}

}  // namespace

void add_demo_sculpt(CLI::App& demo) {
    auto options = std::make_shared<ChangingOptions>();
    options->source.volume() = "synthetic:shepp-logan";
    options->output = "palpate-sculpt";
    options->brush.radius = 5;
    options->brush.rate = 6;  // slow enough to be felt
    options->hand.depth_mm = 4;
    CLI::App* command =
        demo.add_subcommand("sculpt", "A simulated hand carves what it feels; an animation");
    command->footer("Example:\n  palpate demo sculpt lobster.nrrd --isovalue 35 --radius 4");
    add_options(*command, *options);
    add_motion_options(*command, options->motion, options->hand);
    command->add_option("--radius", options->brush.radius, "Radius of the brush [mm]")
        ->capture_default_str();
    command->add_option("--brush-rate", options->brush.rate, "How fast the brush works [1/s]")
        ->capture_default_str();
    command->callback([options] {
        options->hand.rate_hz = options->render.given.rate;
        sculpt(*options);
    });
}

void add_demo_beating(CLI::App& demo) {
    auto options = std::make_shared<ChangingOptions>();
    options->source.volume() = "synthetic:beating";
    options->output = "palpate-beating";
    options->hand.depth_mm = 5;
    CLI::App* command = demo.add_subcommand(
        "beating", "A hand rests on a surface that moves, of a sequence; an animation");
    command->footer("Example:\n  palpate demo beating heart.nii.gz --isovalue 120");
    add_options(*command, *options);
    command->add_option("--beats", options->beats, "How often the sequence goes round")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->callback([options] {
        options->hand.rate_hz = options->render.given.rate;
        beating(*options);
    });
}

}  // namespace palpate::app
