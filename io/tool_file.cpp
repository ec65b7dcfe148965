// Makes a tool from the text of options.
#include "palpate/io/tool_file.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "io/system/number.hpp"
#include "palpate/io/csv.hpp"
#include "palpate/io/mesh_file.hpp"
#include "palpate/names.hpp"
#include "palpate/session.hpp"

namespace palpate::io {
namespace {

constexpr const char* wanted =
    "point, sphere:RADIUS, rod:LENGTH, needle[:LENGTH,RADIUS], burr:RADIUS, box:X,Y,Z, fingertip "
    "(lengths in mm), or a file: points (.csv) or a mesh (.stl, .ply, .obj, .vtp)";

[[noreturn]] void refuse(const std::string& text) {
    static const std::vector<std::string> names = {"point", "sphere", "rod",      "needle",
                                                   "burr",  "box",    "fingertip"};
    const std::size_t end = std::min(text.find(':'), text.size());
    const std::string near = nearest_name(std::string_view(text).substr(0, end), names);
    const std::string sizes = near == "point" || near == "fingertip" ? "" : text.substr(end);
    throw std::invalid_argument("the tool '" + text + "' is not known: it is " + wanted +
                                (near.empty() ? near : " (did you mean " + near + sizes + "?)"));
}

/// "box:2,2,2"
std::string example(const std::string& text, std::size_t count) {
    std::string made = text.substr(0, text.find(':')) + ":2";
    for (std::size_t i = 1; i < count; ++i) made += ",2";
    return made;
}

/// The sizes after the colon, each finite and above 0.
template <std::size_t count>
std::array<double, count> sizes_from(const std::string& text, std::string_view sizes) {
    std::array<double, count> found{};
    for (std::size_t i = 0; i < count; ++i) {
        const auto comma = sizes.find(',');
        const bool last = i + 1 == count;
        const auto number = number_from<double>(sizes.substr(0, comma));
        if (!number || !(*number > 0 && *number < 1e6) || last != (comma == sizes.npos)) {
            throw std::invalid_argument("the tool '" + text + "': " + std::to_string(count) +
                                        (count == 1 ? " length" : " lengths") +
                                        " above 0 and below 1e6 [mm] must follow a colon, as in " +
                                        example(text, count));
        }
        found[i] = *number;
        sizes.remove_prefix(last ? sizes.size() : comma + 1);
    }
    return found;
}

}  // namespace

std::vector<Vec3> parse_tool_points(std::string_view text, const std::string& name) {
    CsvReader rows(text, name);
    const std::array columns{rows.column("x"), rows.column("y"), rows.column("z")};
    std::vector<Vec3> points;
    while (rows.next()) {
        if (points.size() == most_tool_points) {
            rows.fail("a tool has at most " + std::to_string(most_tool_points) +
                      " points: space them farther apart");
        }
        points.emplace_back(rows.finite_number(columns[0]), rows.finite_number(columns[1]),
                            rows.finite_number(columns[2]));
    }
    if (points.empty()) throw InputError(name + ": has a header and no points: add at least one");
    return points;
}

ToolSpec tool_spec_from(const std::string& text, const OnProgress& progress, std::uint64_t memory) {
    const auto colon = text.find(':');
    const std::string name = text.substr(0, colon);
    const bool has_sizes = colon != std::string::npos;
    const std::string_view sizes =
        has_sizes ? std::string_view(text).substr(colon + 1) : std::string_view();
    const auto one = [&] { return sizes_from<1>(text, sizes)[0]; };
    if (text == "point") return PointSpec{};
    if (text == "fingertip") return FingertipSpec{};
    if (text == "needle") return NeedleSpec{};
    if (name == "sphere") return SphereSpec{one()};
    if (name == "rod") return RodSpec{one()};
    if (name == "burr") return BurrSpec{one()};
    if (name == "needle") {
        const auto [length, radius] = sizes_from<2>(text, sizes);
        return NeedleSpec{length, radius};
    }
    if (name == "box") {
        const auto [x, y, z] = sizes_from<3>(text, sizes);
        return BoxSpec{{x, y, z}};
    }
    if (std::filesystem::path(text).extension() == ".csv") {
        return PointsSpec{parse_tool_points(read_text(text, progress), text)};
    }
    if (names_a_mesh(text)) {
        SurfaceMesh mesh = read_mesh(text, progress, memory);
        return MeshSpec{std::make_shared<const ToolShape>(
            ToolShape{std::move(mesh.vertices), std::move(mesh.triangles)})};
    }
    refuse(text);
}

std::shared_ptr<const Tool> make_tool(const ToolSpec& spec, double spacing,
                                      const OnProgress& progress) {
    const Overloaded make{
        [](const PointSpec&) { return point_tool(); },
        [&](const SphereSpec& s) { return sphere_tool(s.radius, spacing); },
        [&](const RodSpec& s) { return rod_tool(s.length, spacing); },
        [&](const NeedleSpec& s) { return needle_tool(s.length, s.radius, spacing); },
        [&](const BurrSpec& s) { return burr_tool(s.radius, spacing); },
        [&](const BoxSpec& s) { return box_tool(s.size, spacing); },
        [&](const FingertipSpec& s) { return fingertip_tool(spacing, s.scale); },
        [](const PointsSpec& s) { return Tool(s.points, std::nullopt, s.turns, s.shape); },
        [&](const MeshSpec& s) { return mesh_tool(*s.mesh, spacing, progress); },
    };
    if (std::holds_alternative<PointSpec>(spec)) return nullptr;
    return std::make_shared<const Tool>(std::visit(make, spec));
}

ToolSpec scaled(const ToolSpec& spec, double factor) {
    if (!(factor > 0 && factor < 1e9)) {
        throw std::invalid_argument("a tool's scale must be a number above 0");
    }
    const auto all = [factor](std::vector<Vec3> points) {
        for (Vec3& point : points) point *= factor;
        return points;
    };
    const Overloaded scale{
        [](const PointSpec& s) -> ToolSpec { return s; },
        [&](const SphereSpec& s) -> ToolSpec { return SphereSpec{s.radius * factor}; },
        [&](const RodSpec& s) -> ToolSpec { return RodSpec{s.length * factor}; },
        [&](const NeedleSpec& s) -> ToolSpec {
            return NeedleSpec{s.length * factor, s.radius * factor};
        },
        [&](const BurrSpec& s) -> ToolSpec { return BurrSpec{s.radius * factor}; },
        [&](const BoxSpec& s) -> ToolSpec { return BoxSpec{s.size * factor}; },
        [&](const FingertipSpec& s) -> ToolSpec { return FingertipSpec{s.scale * factor}; },
        [&](const PointsSpec& s) -> ToolSpec {
            return PointsSpec{all(s.points), s.turns, {all(s.shape.vertices), s.shape.triangles}};
        },
        [&](const MeshSpec& s) -> ToolSpec {
            return MeshSpec{std::make_shared<const ToolShape>(
                ToolShape{all(s.mesh->vertices), s.mesh->triangles})};
        },
    };
    return std::visit(scale, spec);
}

double usual_spacing(const Geometry& geometry) {
    return 0.5 * geometry.spacing.minCoeff();
}

}  // namespace palpate::io
