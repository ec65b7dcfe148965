// palpate tool: describes a tool and its contact points, before you touch with it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "apps/options/no_effect.hpp"
#include "apps/options/values.hpp"
#include "apps/palpate/commands.hpp"
#include "apps/palpate/outputs.hpp"
#include "apps/palpate/picture.hpp"
#include "io/system/number.hpp"
#include "palpate/io/output.hpp"
#include "palpate/io/tool_file.hpp"
#include "pictures/surface.hpp"
#include "pictures/view.hpp"

namespace palpate::app {
namespace {

struct ToolOptions {
    std::string spec, points, picture;
    double spacing = 0.5;  // [mm]
    bool json = false, quiet = false;
};

void write_points(const Tool& tool, io::PendingFile& file) {
    file.write("x,y,z\n");
    for (const Vec3& point : tool.points()) {
        std::string line;
        for (int a = 0; a < 3; ++a) {
            if (a > 0) line += ',';
            io::append_number(line, point[a]);
        }
        file.write(line + '\n');
    }
}

/// A ball at each point, as one mesh: an octahedron whose edges are halved twice.
pictures::Surface beads(std::span<const Vec3> points, double radius) {
    std::vector<Vec3> ball{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<std::array<std::uint32_t, 3>> faces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int round = 0; round < 2; ++round) {
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const auto n = static_cast<std::uint32_t>(ball.size());
            for (const auto& [i, j] : {std::pair{a, b}, {b, c}, {c, a}}) {
                ball.push_back((ball[i] + ball[j]).normalized());
            }
            finer.insert(finer.end(),
                         {{a, n, n + 2}, {n, b, n + 1}, {n + 2, n + 1, c}, {n, n + 1, n + 2}});
        }
        faces = std::move(finer);
    }
    pictures::Surface surface;
    for (const Vec3& point : points) {
        const auto first = static_cast<std::uint32_t>(surface.mesh.vertices.size());
        for (const Vec3& normal : ball) {
            surface.mesh.vertices.push_back(point + radius * normal);
            surface.normals.push_back(normal.cast<float>());
        }
        for (const auto& [a, b, c] : faces) {
            surface.mesh.triangles.push_back({first + a, first + b, first + c});
        }
    }
    return surface;
}

/// The points as balls on the tool's shape, if it has one; its z axis is up.
pictures::PictureScene picture_of(const ToolOptions& options, const Tool& tool) {
    pictures::PictureScene scene;
    scene.title = std::filesystem::path(options.spec).filename().string();
    scene.orientation = false;  // a tool has no body's sides
    pictures::Surface points = beads(tool.points(), 0.2 * options.spacing);
    points.colour = pictures::scp_colour;
    points.label = fmt::format("{} points", tool.points().size());
    scene.surfaces.push_back(std::move(points));
    if (const ToolShape& shape = tool.shape(); !shape.triangles.empty()) {
        pictures::Surface surface;
        surface.mesh.vertices = shape.vertices;
        surface.mesh.triangles = shape.triangles;
        surface.normals = pictures::mesh_normals(surface.mesh);
        surface.label = "the tool";
        scene.surfaces.push_back(std::move(surface));
    }
    pictures::frame(scene, pictures::view_named("oblique"));
    return scene;
}

void describe(const CLI::App& command, const ToolOptions& options) {
    check_outputs({options.spec}, {options.points, options.picture});
    if (!options.picture.empty()) require_png("--picture", options.picture);
    const bool table = is_standard_output(options.points);
    const bool picture = is_standard_output(options.picture);
    if (options.json + table + picture > 1) {
        throw std::invalid_argument(
            "--json, a table and a picture cannot share standard output: give them files");
    }
    const io::ToolSpec spec = io::tool_spec_from(options.spec, stop_if_interrupted);
    if (std::holds_alternative<io::PointSpec>(spec) ||
        std::holds_alternative<io::PointsSpec>(spec)) {
        warn_of_no_effect(command, {"--spacing"}, "the points of this tool are given");
    }
    const auto made = io::make_tool(spec, options.spacing, stop_if_interrupted);
    const Tool tool = made ? *made : point_tool();
    if (!options.points.empty()) {
        io::PendingFile file(options.points);
        write_points(tool, file);
        stop_if_interrupted();
        file.commit();
    }
    if (!options.picture.empty()) {
        io::PendingFile file(options.picture);
        file.write(draw(picture_of(options, tool)));
        stop_if_interrupted();
        file.commit();
    }
    Vec3 low = tool.points().front(), high = low;
    for (const Vec3& point : tool.points()) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const Vec3 size = high - low;
    if (options.json) {
        print_json({{"points", tool.points().size()},
                    {"low_mm", {low[0], low[1], low[2]}},
                    {"high_mm", {high[0], high[1], high[2]}},
                    {"radius_mm", tool.radius()},
                    {"gyration_mm", tool.gyration()},
                    {"turns", tool.turns()}});
    } else if (!options.quiet && !table && !picture) {
        fmt::print("{}: {} points, {:.4g} x {:.4g} x {:.4g} mm, gyration {:.4g} mm{}\n",
                   options.spec, tool.points().size(), size[0], size[1], size[2], tool.gyration(),
                   tool.turns() ? "" : ", keeps its orientation");
    }
}

}  // namespace

void add_tool(CLI::App& app) {
    auto options = std::make_shared<ToolOptions>();
    CLI::App* command =
        app.add_subcommand("tool", "Describe a tool: its contact points and its size");
    command->footer(
        "Tools: point, sphere:R, rod:L, needle[:L,R], burr:R, box:X,Y,Z, fingertip (lengths in "
        "mm), a file of points (CSV with columns x,y,z), or a mesh (.stl, .ply, .obj, .vtp; mm, "
        "its origin is the reference point).\n\nExample:\n  palpate tool burr:2 "
        "--spacing 0.25 --points burr.csv --picture burr.png");
    command->add_option("TOOL", options->spec, "The tool")
        ->type_name("{point,sphere:,rod:,needle,burr:,box:,fingertip}|FILE.{csv,stl,ply,obj,vtp}")
        ->required();
    command
        ->add_option("--spacing", options->spacing,
                     "Distance between neighbouring points [mm]. When you touch, the default is "
                     "half a voxel")
        ->check(above_zero())
        ->capture_default_str();
    command
        ->add_option("--points", options->points,
                     "Table of the points to write (x,y,z; mm, tool axes)")
        ->type_name("FILE.csv");
    command->add_option("--picture", options->picture, "Picture of the points on the tool to write")
        ->type_name("FILE.png");
    command->add_flag("--json", options->json, "Print the summary as JSON");
    command->add_flag("-q,--quiet", options->quiet, "Print nothing");
    command->callback([options, command] { describe(*command, *options); });
}

}  // namespace palpate::app
