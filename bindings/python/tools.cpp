// Rigid tools.
#include "palpate/tool.hpp"

#include <algorithm>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "palpate/io/tool_file.hpp"

namespace palpate::python {
namespace {

using Made = std::shared_ptr<Tool>;

Made made(Tool tool) {
    return std::make_shared<Tool>(std::move(tool));
}

Made from_text(const std::filesystem::path& text, double spacing) {
    const GilReleased unlocked;
    const auto tool = io::make_tool(io::tool_spec_from(text.string(), ctrl_c()), spacing, ctrl_c());
    return made(tool ? *tool : point_tool());
}

py::array_t<double> points_of(const Tool& tool) {
    const auto points = tool.points();
    return array_from(std::vector<Vec3>(points.begin(), points.end()));
}

}  // namespace

void bind_tools(py::module_& module) {
    py::class_<Tool, std::shared_ptr<Tool>>(
        module, "Tool", "A rigid body that touches with points of its surface (docs/tools.md).")
        .def(py::init([](const Doubles& points, std::optional<double> gyration, bool turns) {
                 std::vector<Vec3> places = points_from(points, "points");
                 const GilReleased unlocked;
                 return made(Tool(std::move(places), gyration, turns));
             }),
             py::arg("points"), py::arg("gyration") = py::none(), py::arg("turns") = true,
             "points [mm], tool axes, shape (n, 3), the reference point at the origin. gyration\n"
             "[mm] weighs rotation against translation. turns=False: it keeps its orientation.")
        .def_static(
            "named", &from_text, py::arg("text"), py::arg("spacing"),
            "'sphere:2', 'rod:30', 'needle:60,0.5', 'burr:3', 'box:10,10,2', 'fingertip', a\n"
            "CSV file of points or a mesh file; points about `spacing` [mm] apart.")
        .def_property_readonly("points", &points_of, "[mm], tool axes, shape (n, 3); a copy.")
        .def_property_readonly("gyration", &Tool::gyration, "[mm]")
        .def_property_readonly("radius", &Tool::radius, "Of the farthest point [mm].")
        .def_property_readonly("turns", &Tool::turns)
        .def(
            "__eq__",
            [](const Tool& one, const Tool& other) {
                return std::ranges::equal(one.points(), other.points()) &&
                       one.gyration() == other.gyration() && one.turns() == other.turns() &&
                       one.shape().vertices == other.shape().vertices &&
                       one.shape().triangles == other.shape().triangles;
            },
            py::is_operator())
        .def("__repr__",
             [](const Tool& t) {
                 return py::str("Tool({} points, gyration {:g} mm, radius {:g} mm)")
                     .format(t.points().size(), t.gyration(), t.radius());
             })
        .def(py::pickle(
            [](const Tool& tool) {
                const ToolShape& shape = tool.shape();
                return py::make_tuple(points_of(tool), tool.gyration(), tool.turns(),
                                      array_from(shape.vertices), shape.triangles);
            },
            [](const py::tuple& s) {
                ToolShape shape{points_from(s[3].cast<Doubles>(), "vertices"),
                                s[4].cast<std::vector<std::array<std::uint32_t, 3>>>()};
                return made(Tool(points_from(s[0].cast<Doubles>(), "points"), s[1].cast<double>(),
                                 s[2].cast<bool>(), std::move(shape)));
            }));
}

}  // namespace palpate::python
