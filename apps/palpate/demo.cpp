// palpate demo: a simulated hand explores a volume, without any argument; leaves a picture, a
// figure, the trace and a report in a folder.
#include <fmt/format.h>

#include <array>
#include <memory>

#include "apps/options/no_effect.hpp"
#include "apps/options/values.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/demo_run.hpp"
#include "apps/palpate/picture.hpp"
#include "apps/palpate/progress.hpp"
#include "palpate/io/output.hpp"
#include "palpate/io/sample_volume.hpp"
#include "palpate/names.hpp"
#include "pictures/levels.hpp"
#include "pictures/view.hpp"

namespace palpate::app {
namespace {

/// From the centre to where the hand touched, on average; zero if it never did.
Vec3 mean_contact(const Demo& demo) {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (const io::TraceRow& row : demo.rows) {
        if (row.constrained) sum += row.scp;
        count += row.constrained;
    }
    if (count == 0) return Vec3::Zero();
    return sum / count - physical_centre(demo.field.geometry());
}

/// The isosurface with the paths of hand and proxy.
pictures::PictureScene picture_of(const Demo& demo, const DemoOptions& options) {
    pictures::PictureScene scene = scene_of(demo, options);
    {
        ProgressBar bar("extracting", options.source.quiet);
        pictures::add_levels(scene, demo.field, std::array{demo.isovalue},
                             [&](double fraction) { bar.at(fraction); });
    }
    pictures::frame(scene, pictures::natural_view(demo.field.geometry(), mean_contact(demo)));
    std::vector<Vec3> hip, scp;
    std::vector<bool> constrained;
    for (const io::TraceRow& row : demo.rows) {
        hip.push_back(row.hip);
        scp.push_back(row.scp);
        constrained.push_back(row.constrained);
    }
    pictures::add_path(scene, hip, scp, constrained);
    return scene;
}

void explore(const DemoOptions& options) {
    Demo demo = load_demo(options);
    demo.trajectory = motion_of(demo, options);
    demo.hand = fmt::format("A simulated hand ({}, {:g} s, {:g} mm/s, {:g} mm deep, {:g} Hz)",
                            options.motion, options.hand.duration_s, options.hand.speed_mm_s,
                            options.hand.depth_mm, options.hand.rate_hz);
    run_demo(demo, options,
             {"surface.png", "The isosurface with the trajectory of the hand",
              "Blue: the hand (HIP). Vermilion: the proxy (SCP) in contact. Fainter where it is "
              "behind the surface.",
              [&](const std::filesystem::path& folder) {
                  io::write_file(folder / "surface.png", draw(picture_of(demo, options)));
              }});
}

/// A kind of demo, misspelt, is taken for a volume. Throws std::invalid_argument.
void refuse_misspelt_kind(const CLI::App& command, const std::string& volume) {
    std::error_code error;
    if (std::filesystem::exists(volume, error)) return;
    std::vector<std::string> kinds;
    for (const CLI::App* kind : command.get_subcommands([](const CLI::App*) { return true; })) {
        kinds.push_back(kind->get_name());
    }
    const std::string near = nearest_name(volume, kinds);
    if (near.empty()) return;
    throw std::invalid_argument(volume + ": does not exist (did you mean demo " + near + "?)");
}

}  // namespace

void add_demo(CLI::App& app) {
    auto options = std::make_shared<DemoOptions>();
    options->motion = "explore";
    options->picture_width = 900;
    options->output = "palpate-demo";
    options->results = {"path.csv"};
    CLI::App* command = app.add_subcommand(
        "demo", "Let a simulated hand explore a volume, and draw pictures and a report");
    command->footer(
        "Examples:\n  palpate demo\n  palpate demo head.nrrd --isovalue 34.5 --motion circle");
    add_demo_sculpt(*command);
    add_demo_beating(*command);
    add_demo_options(*command, *options);
    add_motion_options(*command, *options);
    command->add_option("--speed", options->hand.speed_mm_s, "Speed of the hand [mm/s]");
    command->add_option("--seed", options->hand.seed, "Seed of the hand's motion")
        ->check(count(largest_count));
    command->callback([options, command] {
        if (!command->get_subcommands().empty()) {  // it has done its own
            for (const CLI::Option* option : command->get_options()) {
                warn_of_no_effect(*command, {option->get_name().c_str()},
                                  "options of " + command->get_subcommands().front()->get_name() +
                                      " stand behind its name");
            }
            return;
        }
        options->hand.rate_hz = options->render.given.rate.value_or(run::usual_rate);
        if (options->source.name().empty()) {
            options->source.volume() = io::sample_volume_path().string();
            if (command->count("--seed") == 0) options->hand.seed = 2;  // over the face
        }
        refuse_misspelt_kind(*command, options->source.name());
        explore(*options);
    });
}

}  // namespace palpate::app
