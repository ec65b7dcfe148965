// palpate tool: what a tool touches with, before it is felt with.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/palpate/commands.hpp"
#include "apps/palpate/outputs.hpp"
#include "io/number.hpp"
#include "palpate/io/output.hpp"
#include "palpate/io/tool_file.hpp"

namespace palpate::app {
namespace {

struct ToolOptions {
    std::string spec, points;
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

void describe(const ToolOptions& options) {
    check_outputs({options.spec}, {options.points});
    if (options.json && is_standard_output(options.points)) {
        throw std::invalid_argument(
            "--json and a table would both go to standard output: give the table a file");
    }
    const auto made = io::make_tool(io::tool_spec_from(options.spec), options.spacing);
    const Tool tool = made ? *made : point_tool();
    if (!options.points.empty()) {
        io::PendingFile file(options.points);
        write_points(tool, file);
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
    } else if (!options.quiet && !is_standard_output(options.points)) {
        fmt::print("{}: {} points, {:.4g} x {:.4g} x {:.4g} mm, gyration {:.4g} mm{}\n",
                   options.spec, tool.points().size(), size[0], size[1], size[2], tool.gyration(),
                   tool.turns() ? "" : ", keeps its orientation");
    }
}

}  // namespace

void add_tool(CLI::App& app) {
    auto options = std::make_shared<ToolOptions>();
    CLI::App* command = app.add_subcommand("tool", "What a tool touches with: its points and size");
    command->footer(
        "Tools: point, sphere:R, rod:L, needle[:L,R], burr:R, box:X,Y,Z, fingertip (lengths in "
        "mm), "
        "or a file of points (CSV with columns x,y,z).\n\nExample:\n  palpate tool burr:2 "
        "--spacing 0.25 --points burr.csv");
    command->add_option("TOOL", options->spec, "The tool")->required();
    command
        ->add_option("--spacing", options->spacing,
                     "Distance of neighbouring points [mm]; when felt: half a voxel")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command->add_option("--points", options->points,
                        "Table of the points to write (CSV: x,y,z; mm, tool axes)");
    command->add_flag("--json", options->json, "Print the summary as JSON");
    command->add_flag("-q,--quiet", options->quiet, "Print nothing");
    command->callback([options] { describe(*options); });
}

}  // namespace palpate::app
