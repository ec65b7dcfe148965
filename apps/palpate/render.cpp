// palpate render: a picture of isosurfaces, hand and proxy, without a display.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/options/no_effect.hpp"
#include "apps/options/say.hpp"
#include "apps/options/source_options.hpp"
#include "apps/options/values.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/picture.hpp"
#include "apps/palpate/progress.hpp"
#include "io/system/number.hpp"
#include "palpate/force.hpp"
#include "palpate/io/output.hpp"
#include "palpate/io/raw_options.hpp"
#include "palpate/io/trace.hpp"
#include "palpate/proxy.hpp"
#include "pictures/contact.hpp"
#include "pictures/levels.hpp"
#include "pictures/view.hpp"

namespace palpate::app {
namespace {

struct RenderPictureOptions {
    SourceOptions source;
    run::FieldSetup field;
    std::vector<std::string> isovalues;
    std::string scp, hip, force;                   ///< X,Y,Z
    double stiffness = ForceSettings{}.stiffness;  ///< [N/mm]
    std::string path;                              ///< of a path file or a trace
    std::string view;
    std::optional<double> azimuth, elevation;  ///< [degrees]
    double roll = 0;                           ///< [degrees] clockwise
    double zoom = 1;
    std::string size = "1000x800";  ///< [pixels]
    std::string output;
};

std::optional<Vec3> point_from(const std::string& option, const std::string& text) {
    if (text.empty()) return {};
    return io::three_numbers_from(text, ',', option);
}

std::array<int, 2> size_from(const std::string& text) {
    const auto cross = text.find('x');
    const auto width = io::number_from<int>(text.substr(0, cross));
    const auto height =
        cross == std::string::npos ? width : io::number_from<int>(text.substr(cross + 1));
    const auto good = [](const auto& n) { return n && *n >= 64 && *n <= 4096; };
    if (cross == std::string::npos || !good(width) || !good(height)) {
        throw std::invalid_argument("--size " + text +
                                    ": WIDTHxHEIGHT is needed, each 64 to 4096 pixels");
    }
    return {*width, *height};
}

/// The levels in the order given; the first is the one that a hand feels.
std::vector<double> levels_of(const RenderPictureOptions& options, const run::LoadedVolume& loaded,
                              const Field& field) {
    std::vector<double> levels;
    if (options.isovalues.empty()) levels.push_back(required_isovalue(loaded, field, {}));
    for (const std::string& text : options.isovalues) {
        const double level = io::level_from_text(text, loaded.volume);
        warn_of_isovalue(field, level);
        if (std::ranges::count(levels, level) > 0) {
            throw std::invalid_argument("--isovalue " + text + ": given twice");
        }
        levels.push_back(level);
    }
    if (levels.size() > pictures::most_levels) {
        throw std::invalid_argument(
            fmt::format("--isovalue: at most {} levels can be told apart", pictures::most_levels));
    }
    return levels;
}

/// Completes the contact: for a hand alone, computes its proxy. Between hand and proxy there is a
/// spring.
pictures::Contact contact_of(const RenderPictureOptions& options, const Field& field,
                             double isovalue) {
    pictures::Contact contact{point_from("--scp", options.scp), point_from("--hip", options.hip),
                              point_from("--force", options.force)};
    if (contact.hip && !contact.scp) {
        Proxy proxy;
        if (!place(proxy, field, *contact.hip, isovalue)) {
            throw std::invalid_argument(
                fmt::format("--hip {}: all of space is solid at isovalue {:g}, so there is no "
                            "proxy: choose another level",
                            options.hip, isovalue));
        }
        contact.scp = update_exact(proxy, field, *contact.hip).scp;
    }
    if (contact.hip && contact.scp && !contact.force) {
        contact.force = options.stiffness * (*contact.scp - *contact.hip);
    }
    if (contact.force && !contact.scp) {
        throw std::invalid_argument("--force needs a place: give --scp or --hip as well");
    }
    return contact;
}

/// The direction from which the contact is visible: out of the surface, or at least away from the
/// middle. Zero if there is no contact.
Vec3 side_of(const pictures::Contact& contact, const io::ProxyPath& path, const Vec3& middle) {
    if (contact.scp && contact.hip && *contact.scp != *contact.hip) {
        return *contact.scp - *contact.hip;
    }
    if (contact.scp) return *contact.scp - middle;
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < path.scp.size(); ++i) {
        if (path.constrained[i]) sum += path.scp[i] - middle;
    }
    return sum;
}

pictures::View view_of(const RenderPictureOptions& options, const Field& field,
                       const pictures::Contact& contact, const io::ProxyPath& path) {
    if (!options.view.empty()) return pictures::view_named(options.view);
    if (options.azimuth || options.elevation) {
        return pictures::view_from(options.azimuth.value_or(0), options.elevation.value_or(0));
    }
    const Geometry& geometry = field.geometry();
    return pictures::natural_view(geometry, side_of(contact, path, physical_centre(geometry)));
}

struct Drawing {
    pictures::PictureScene scene;
    std::string summary;  ///< what is in it, in words
};

std::string text_of(const Vec3& p) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0], p[1], p[2]);
}

std::string summary_of(const pictures::PictureScene& scene, const pictures::Contact& contact) {
    std::string text = fmt::format("{} x {} pixels", scene.width, scene.height);
    for (const pictures::Surface& s : scene.surfaces) {
        text += fmt::format(", {} ({} triangles)", s.label, s.mesh.triangles.size());
    }
    if (contact.hip) text += ", HIP " + text_of(*contact.hip);
    if (contact.scp) text += ", SCP " + text_of(*contact.scp);
    if (contact.force) text += fmt::format(" mm, force {:.4g} N", contact.force->norm());
    return text;
}

Drawing drawing_of(const RenderPictureOptions& options) {
    const run::LoadedVolume loaded = load_whole(options.source);
    const Field field = run::make_field(loaded.volume, options.field);
    const std::vector<double> levels = levels_of(options, loaded, field);
    const pictures::Contact contact = contact_of(options, field, levels.front());
    const io::ProxyPath path = options.path.empty()
                                   ? io::ProxyPath{}
                                   : io::read_proxy_path(options.path, stop_if_interrupted);
    Drawing drawing;
    pictures::PictureScene& scene = drawing.scene;
    const auto [width, height] = size_from(options.size);
    scene = scene_of(loaded, width, height);
    {
        ProgressBar bar("extracting", options.source.quiet);
        const int every =
            pictures::add_levels(scene, field, levels, [&](double fraction) { bar.at(fraction); });
        if (every > 1 && !options.source.quiet) {
            say("palpate: note: {}: too large for a picture: drawn from one in {} samples "
                "along each axis, without finer details\n",
                loaded.name, every);
        }
    }
    pictures::frame(scene, pictures::rolled(view_of(options, field, contact, path), options.roll),
                    options.zoom, contact.scp ? contact.scp : contact.hip);
    pictures::add_path(scene, path.hip, path.scp, path.constrained);
    pictures::add_contact(scene, contact);
    drawing.summary = summary_of(scene, contact);
    return drawing;
}

void render(const CLI::App& command, const RenderPictureOptions& options) {
    require_png("--output", options.output);
    check_outputs({options.source.name(), options.path}, {options.output});
    (void)size_from(options.size);
    if (!options.force.empty()) {
        warn_of_no_effect(command, {"--stiffness"}, "--force gives the force");
    } else if (options.hip.empty()) {
        warn_of_no_effect(command, {"--stiffness"}, "there is no force without --hip");
    }
    io::PendingFile file(options.output);
    const Drawing drawing = drawing_of(options);
    file.write(draw(drawing.scene));
    stop_if_interrupted();
    file.commit();
    if (!options.source.quiet && !is_standard_output(options.output)) {
        fmt::print("{}: {}\n", options.output, drawing.summary);
    }
}

}  // namespace

void add_render(CLI::App& app) {
    auto options = std::make_shared<RenderPictureOptions>();
    CLI::App* command = app.add_subcommand(
        "render", "Draw isosurfaces, hand and proxy as a picture, without a display");
    command->footer(
        "Points are physical (LPS, mm). With --hip alone, the proxy is computed at the first "
        "--isovalue.\n\nExamples:\n"
        "  palpate render head.nrrd --isovalue 34.5 --isovalue 99.5 --output head.png\n"
        "  palpate render synthetic:torus --hip 0,-20,8 --zoom 3 --output contact.png");
    options->source.add_to(*command, SourceOptions::For::surfaces);
    command
        ->add_option(
            "-i,--isovalue", options->isovalues,
            "Isovalue to draw, in the data's units (300) or percent of its range (53%). May "
            "be given again: the outer surfaces are translucent")
        ->allow_extra_args(false);
    add_side_options(*command, options->field);
    command->add_option("--scp", options->scp, "The proxy [mm, physical]")->type_name("X,Y,Z");
    command->add_option("--hip", options->hip, "The hand [mm, physical]")->type_name("X,Y,Z");
    command
        ->add_option("--force", options->force,
                     "Force on the hand [N] (default: stiffness (SCP - HIP))")
        ->type_name("X,Y,Z");
    command->add_option("-k,--stiffness", options->stiffness, "Stiffness of the spring [N/mm]")
        ->check(from_zero())
        ->capture_default_str();
    command->add_option("--path", options->path, "Path to draw: a trace or a path of replay")
        ->type_name("FILE.csv");
    auto* view = command
                     ->add_option("--view", options->view,
                                  "Side of the body to look at (default: the one that shows most)")
                     ->check(one_of(pictures::view_names()));
    command
        ->add_option("--azimuth", options->azimuth,
                     "Direction of the view [degrees]: 0 is the front, 90 the body's left side")
        ->excludes(view);
    command->add_option("--elevation", options->elevation, "Look from above [degrees], -90 to 90")
        ->excludes(view);
    command->add_option("--roll", options->roll, "Turn the picture clockwise [degrees]")
        ->check(from_to(-360.0, 360.0))
        ->capture_default_str();
    command->add_option("--zoom", options->zoom, "Magnification, about the proxy if there is one")
        ->check(from_to(0.1, 1000.0))
        ->capture_default_str();
    command->add_option("--size", options->size, "Size of the picture [pixels]")
        ->type_name("WxH")
        ->capture_default_str();
    command->add_option("-o,--output", options->output, "Picture to write")
        ->type_name("FILE.png")
        ->required();
    command->callback([options, command] { render(*command, *options); });
}

}  // namespace palpate::app
