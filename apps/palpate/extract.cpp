// palpate extract: the whole isosurface as a watertight mesh, for looking at.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "apps/options/no_effect.hpp"
#include "apps/options/source_options.hpp"
#include "apps/options/values.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/progress.hpp"
#include "palpate/io/mesh_file.hpp"
#include "palpate/surface.hpp"

namespace palpate::app {
namespace {

struct ExtractOptions {
    SourceOptions source;
    run::FieldSetup field;
    std::string output;
    double tolerance = 0;  // [voxel]
    bool json = false;
};

void extract(const CLI::App& command, const ExtractOptions& options) {
    (void)io::mesh_format_from(options.output);  // refuse before the work, not after it
    check_outputs({options.source.name()}, {options.output});
    const run::LoadedVolume loaded = load_whole(options.source);
    const Field field = run::make_field(loaded.volume, options.field);
    if (field.interpolation() == Interpolation::linear) {
        warn_of_no_effect(command, {"--tolerance"}, "the facets of the linear field are exact");
    }
    const double isovalue = required_isovalue(loaded, field, options.field);
    SurfaceMesh mesh;
    {
        ProgressBar bar("extracting", options.source.quiet);
        SurfaceOptions surface;
        surface.tolerance = options.tolerance;
        surface.normals = true;
        surface.progress = [&](double fraction) {
            bar.at(fraction);
            return true;
        };
        mesh = extract_surface(field, isovalue, surface);
    }
    {
        ProgressBar bar("writing", options.source.quiet);
        io::write_mesh(mesh, options.output, [&](double fraction) { bar.at(fraction); });
    }
    stop_if_interrupted();
    if (options.json) {
        print_json({{"isovalue", isovalue},
                    {"vertices", mesh.vertices.size()},
                    {"triangles", mesh.triangles.size()},
                    {"enclosed_volume_mm3", enclosed_volume(mesh)}});
    } else if (!options.source.quiet) {
        fmt::print("{}: isovalue {}, {} vertices, {} triangles, encloses {:.6g} mm3\n",
                   options.output, isovalue, mesh.vertices.size(), mesh.triangles.size(),
                   enclosed_volume(mesh));
    }
}

}  // namespace

void add_extract(CLI::App& app) {
    auto options = std::make_shared<ExtractOptions>();
    CLI::App* command =
        app.add_subcommand("extract", "Write the whole isosurface as a watertight mesh");
    command->footer(
        "The mesh is the surface that the proxy touches. Coordinates are LPS, in mm.\n\nExample:\n "
        " palpate extract head.nrrd --isovalue 99.5 --output skull.ply");
    options->source.add_to(*command, SourceOptions::For::surfaces);
    add_field_options(*command, options->field);
    command->add_option("-o,--output", options->output, "Mesh to write")
        ->type_name("FILE.{ply,stl,obj,vtp}")
        ->required();
    command
        ->add_option("--tolerance", options->tolerance,
                     "Split facets of the smooth surface until they are this close to it [voxel]")
        ->check(from_to(1e-6, 1.0));
    command->add_flag("--json", options->json, "Print the summary as JSON");
    command->callback([options, command] { extract(*command, *options); });
}

}  // namespace palpate::app
