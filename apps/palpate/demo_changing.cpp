// palpate demo sculpt and palpate demo beating: data that change while a simulated hand feels them,
// as an animation.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include "apps/options/values.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/demo_run.hpp"
#include "apps/palpate/picture.hpp"
#include "apps/palpate/progress.hpp"
#include "palpate/edit.hpp"
#include "palpate/io/output.hpp"
#include "palpate/names.hpp"
#include "palpate/run/brush.hpp"
#include "pictures/animation.hpp"
#include "pictures/contact.hpp"
#include "pictures/levels.hpp"
#include "pictures/view.hpp"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

/// [ticks] between two strokes of the brush.
constexpr std::int64_t brush_interval = 4;
/// [mm] Distance from which the hand of `beating` comes.
constexpr double approach = 12;

struct ChangingOptions : DemoOptions {
    run::HandBrush brush;
    int beats = 4;
    int pictures = 24;
};

/// Which moments the animation shows.
struct Animation {
    std::int64_t first = 0;  ///< tick of the first picture
    double seconds_per_picture = 0.1;
    std::optional<pictures::View> view = {};  ///< nothing: a view of the contact
};

/// A moment of which a picture is made.
struct Moment {
    Field field;
    io::TraceRow row;
};

pictures::PictureScene picture_of(const Demo& demo, const Moment& moment,
                                  pictures::PictureScene scene, const pictures::View& view) {
    // Directed by the grid, not by the surface: that changes from picture to picture.
    pictures::PictureScene grid = scene;
    const Geometry& geometry = moment.field.geometry();
    const SampleBox box = whole_box(geometry);
    for (const Index3& corner : {box.low, box.high}) {
        grid.balls.push_back({physical_from_index(geometry, corner.cast<double>()), 1, {}, {}});
    }
    pictures::frame(grid, view, 1.3);
    scene.camera = grid.camera;
    pictures::add_levels(scene, moment.field, std::array{demo.isovalue});
    pictures::Contact contact{moment.row.scp, moment.row.hip, {}};
    if (moment.row.force.norm() > 0) contact.force = moment.row.force;
    pictures::add_contact(scene, contact);
    return scene;
}

/// Writes the animation and the last of its pictures.
void animate(const Demo& demo, const std::vector<Moment>& moments, const Animation& animation,
             const ChangingOptions& options, const fs::path& folder) {
    const Geometry& geometry = demo.field.geometry();
    Vec3 towards = Vec3::Zero();
    for (const Moment& moment : moments) towards += moment.row.scp - physical_centre(geometry);
    const pictures::View view = animation.view.value_or(pictures::natural_view(geometry, towards));
    std::vector<std::string> pngs;
    ProgressBar bar("drawing", options.source.quiet);
    for (const Moment& moment : moments) {
        pngs.push_back(draw(picture_of(demo, moment, scene_of(demo, options), view)));
        bar.at(static_cast<double>(pngs.size()) / static_cast<double>(moments.size()));
    }
    io::write_file(folder / "animation.png",
                   pictures::animation_of(pngs, animation.seconds_per_picture));
    io::write_file(folder / "surface.png", pngs.back());
}

/// Feels, keeps the moments of the animation, draws and reports.
void run_changing(Demo& demo, const Animation& animation, const ChangingOptions& options,
                  const std::function<void(const fs::path& folder)>& more = {}) {
    std::vector<Moment> moments;
    const auto ticks = static_cast<std::int64_t>(demo.trajectory.time.size());
    demo.after = [&](const Renderer& renderer, const io::TraceRow& row) {
        const auto number = static_cast<std::int64_t>(moments.size());
        const std::int64_t due =
            animation.first + (ticks - animation.first) * number / options.pictures;
        const auto tick = static_cast<std::int64_t>(demo.rows.size()) - 1;
        if (number < options.pictures && tick >= due) moments.push_back({renderer.field, row});
    };
    run_demo(demo, options,
             {"animation.png", "The surface while it changes",
              "Blue: the hand (HIP). Vermilion: the proxy (SCP). Green: the force.",
              [&](const fs::path& folder) { animate(demo, moments, animation, options, folder); }},
             more);
}

void sculpt(const ChangingOptions& options) {
    run::check(options.brush);
    Demo demo = load_demo(options);
    demo.trajectory = motion_of(demo, options);
    demo.hand = fmt::format("A simulated hand ({}) with a brush ({}, {:g} mm)", options.motion,
                            enum_name(options.brush.kind), options.brush.radius);
    const Field field = demo.field;
    Editor editor(field.shared_samples());
    std::optional<Vec3> from;
    const double dt = static_cast<double>(brush_interval) / options.hand.rate_hz;
    demo.change = [&](Renderer& renderer, std::int64_t tick) {
        if (tick % brush_interval != 0) return;
        const Proxy& proxy = renderer.proxy;
        if (proxy.mode == Mode::free) return from.reset();
        const Vec3 before = from.value_or(proxy.scp_physical);
        const auto brush =
            from ? run::brush_at(options.brush, field, proxy.isovalue, dt) : std::nullopt;
        from = proxy.scp_physical;
        if (!brush) return;
        editor.apply(edit::Stroke{*brush, before, *from}, EditStep::same);
        field_will_change(renderer.proxy, renderer.field);
        renderer.field.use(editor.samples());
    };
    run_changing(demo, {.seconds_per_picture = options.hand.duration_s / options.pictures}, options,
                 [&](const fs::path& folder) {
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
    if (!ray.hit) {
        throw std::invalid_argument(
            fmt::format("the hand comes along the first axis of the grid and meets no surface of "
                        "isovalue {:g} in the first frame: choose another --isovalue",
                        isovalue));
    }
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
    Demo demo = load_demo(options);
    const io::Sequence& sequence = demo.loaded.sequence;
    if (sequence.count() < 2) {
        throw std::invalid_argument(demo.loaded.name + ": is no sequence: it has one frame only");
    }
    demo.field = Field(all_frames(demo.loaded, options.source.quiet), demo.field.solid(),
                       demo.field.background(), demo.field.interpolation());
    const double period = sequence.period;
    const double rate = options.hand.rate_hz;
    demo.trajectory = resting_hand(demo.field, demo.isovalue, options.hand.depth_mm,
                                   options.beats * period, rate);
    demo.hand = fmt::format("A hand that rests {:g} mm deep in a surface of period {:g} s",
                            options.hand.depth_mm, period);
    demo.change = [begin = sequence.times.front(), rate](Renderer& renderer, std::int64_t tick) {
        field_will_change(renderer.proxy, renderer.field);
        renderer.field.set_time(begin + static_cast<double>(tick) / rate);
    };
    const auto ticks = static_cast<std::int64_t>(demo.trajectory.time.size());
    run_changing(demo,
                 {.first = ticks - static_cast<std::int64_t>(period * rate),
                  .seconds_per_picture = period / options.pictures,
                  .view = pictures::view_from(25, 15)},  // the hand comes from the side
                 options);
}

/// A subcommand with the options that both share.
CLI::App* add_changing(CLI::App& demo, const char* name, const char* what,
                       const std::shared_ptr<ChangingOptions>& options,
                       void (*run)(const ChangingOptions&)) {
    options->picture_width = 480;
    CLI::App* command = demo.add_subcommand(name, what);
    add_demo_options(*command, *options);
    command->add_option("--pictures", options->pictures, "Number of pictures in the animation")
        ->check(from_to(2, 240));
    command->callback([options, run] {
        options->hand.rate_hz = options->render.given.rate.value_or(run::usual_rate);
        run(*options);
    });
    return command;
}

}  // namespace

void add_demo_sculpt(CLI::App& demo) {
    auto options = std::make_shared<ChangingOptions>();
    options->source.volume() = "synthetic:shepp-logan";
    options->output = "palpate-sculpt";
    options->results = {"animation.png", "edited.nrrd"};
    options->motion = "slide";
    options->brush.radius = 5;
    options->brush.rate = 6;  // slow enough to be felt
    options->hand.duration_s = 4;
    options->hand.depth_mm = 4;
    CLI::App* command = add_changing(
        demo, "sculpt", "Let a simulated hand carve the surface that it touches, as an animation",
        options, sculpt);
    command->footer("Example:\n  palpate demo sculpt head.nrrd --isovalue 34.5 --radius 4");
    add_motion_options(*command, *options);
    command->add_option("--radius", options->brush.radius, "Radius of the brush [mm]");
    command->add_option("--brush-rate", options->brush.rate, "Rate of the brush [1/s]");
}

void add_demo_beating(CLI::App& demo) {
    auto options = std::make_shared<ChangingOptions>();
    options->source.volume() = "synthetic:beating";
    options->output = "palpate-beating";
    options->results = {"animation.png"};
    options->hand.depth_mm = 5;
    CLI::App* command = add_changing(
        demo, "beating",
        "Let a simulated hand rest on the moving surface of a sequence, as an animation", options,
        beating);
    command->footer("Example:\n  palpate demo beating synthetic:beating:48x48x48 --beats 2");
    command->add_option("--beats", options->beats, "Number of times that the sequence is played")
        ->check(from_to(1, 1000));
}

}  // namespace palpate::app
