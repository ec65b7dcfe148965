// Tools as options name them: a built-in shape with its sizes, or a file of points or of a mesh.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "palpate/io/error.hpp"
#include "palpate/progress.hpp"
#include "palpate/tool.hpp"

namespace palpate::io {

// Lengths in mm.
struct PointSpec {};
struct SphereSpec {
    double radius;
};
struct RodSpec {
    double length;
};
struct NeedleSpec {
    double length = 60, radius = 0.5;
};
struct BurrSpec {
    double radius;
};
struct BoxSpec {
    Vec3 size;
};
struct FingertipSpec {
    double scale = 1;
};
struct PointsSpec {
    std::vector<Vec3> points;  ///< tool axes
    bool turns = true;
    ToolShape shape = {};
};

struct MeshSpec {
    std::shared_ptr<const ToolShape> mesh;  ///< not null
};

/// The description of a tool. Its points follow from their spacing.
using ToolSpec = std::variant<PointSpec, SphereSpec, RodSpec, NeedleSpec, BurrSpec, BoxSpec,
                              FingertipSpec, PointsSpec, MeshSpec>;

/// "point", "sphere:RADIUS", "rod:LENGTH", "needle[:LENGTH,RADIUS]", "burr:RADIUS", "box:X,Y,Z",
/// "fingertip", the name of a CSV file with columns x, y, z, whose points are the tool's, or that
/// of a mesh (.stl, .ply, .obj, .vtp). Lengths in files are mm in tool axes. Throws
/// std::invalid_argument for other text, InputError for a file that cannot be read. Exceptions
/// of `progress` are passed on. `memory`: as for read_mesh().
ToolSpec tool_spec_from(const std::string& text, const OnProgress& progress = {},
                        std::uint64_t memory = 0);
/// The tool with neighbouring points about `spacing` [mm] apart; those of a file stay as they are.
/// Null for a point. Throws std::invalid_argument for impossible sizes, and for more points than a
/// tool may have. Exceptions of `progress` are passed on.
std::shared_ptr<const Tool> make_tool(const ToolSpec& spec, double spacing,
                                      const OnProgress& progress = {});
/// The same tool, `factor` times as large. Throws std::invalid_argument for a factor that is not
/// above 0.
ToolSpec scaled(const ToolSpec& spec, double factor);
/// Half of the smallest distance of samples [mm].
double usual_spacing(const Geometry& geometry);

/// The points of a tool file. Throws InputError, which calls the text `name`.
std::vector<Vec3> parse_tool_points(std::string_view text, const std::string& name);

}  // namespace palpate::io
