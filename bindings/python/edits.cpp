// Edits as values, and the editor with undo and redo.
#include "palpate/edit.hpp"

#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "palpate/run/brush.hpp"

namespace palpate::python {
namespace {

using Box = std::pair<Index3, Index3>;

std::optional<Box> box_of(const SampleBox& box) {
    if (box.empty()) return std::nullopt;
    return Box(box.low, box.high);
}

edit::Fill filled_box(const Index3& low, const Index3& high, double value) {
    check_numbers("value", value, ranges::finite);
    const SampleBox box{low, high};
    if (box.empty()) throw std::invalid_argument("high must not lie below low along any axis");
    return {box, value};
}

void bind_brushes(py::module_& module) {
    Record<Brush>(module, "Brush", "A round brush.").settings().done();
    Record<run::HandBrush>(module, "HandBrush", "A brush that follows the proxy while it touches.")
        .settings()
        .done();
    module.def(
        "brush_for",
        [](BrushKind kind, const Field& field, double isovalue, double radius) {
            check_numbers("isovalue", isovalue, ranges::finite);
            check_numbers("radius", radius, ranges::positive);
            return brush_for(kind, field, isovalue, radius);
        },
        py::arg("kind"), py::arg("field"), py::arg("isovalue"), py::arg("radius"),
        "A Brush for the level that is felt; radius [mm].");
}

void bind_bodies(py::module_& module) {
    py::class_<ToolBody, std::shared_ptr<ToolBody>>(
        module, "ToolBody", "The solid of a Tool, as distances from its surface, for a Sweep.")
        .def(py::init([](const std::shared_ptr<Tool>& tool, double step, double reach) {
                 const GilReleased unlocked;
                 return std::make_shared<ToolBody>(tool, step, reach);
             }),
             py::arg("tool").none(false), py::arg("step"), py::arg("reach"),
             "Distances at places `step` [mm] apart, known up to `reach` [mm] from the surface.\n"
             "body_for() chooses both for a brush.")
        .def_property_readonly(
            "tool", [](const ToolBody& b) { return std::const_pointer_cast<Tool>(b.tool()); })
        .def_property_readonly("step", &ToolBody::step, "[mm]")
        .def_property_readonly("reach", &ToolBody::reach, "[mm]")
        .def_property_readonly(
            "is_closed", &ToolBody::is_closed,
            "Whether the surface encloses the body. Otherwise it has no inside.");
    module.def(
        "body_for",
        [](const Brush& brush, const Geometry& geometry, const std::shared_ptr<Tool>& tool) {
            const GilReleased unlocked;
            check_ranges(brush);
            return std::make_shared<ToolBody>(body_for(brush, geometry, tool));
        },
        py::arg("brush"), py::arg("geometry"), py::arg("tool").none(false),
        "The ToolBody of a tool for sweeps of this brush on a grid.");
}

void bind_sweeps(py::module_& module) {
    using S = edit::Sweep;
    py::class_<S>(module, "Sweep",
                  "A brush with the shape of a tool, swept between two poses: it moves straight\n"
                  "and turns evenly.")
        .def(py::init([](const Brush& brush, const std::shared_ptr<ToolBody>& body,
                         const Vec3& start, const Vec3& end, const Quaternion& start_orientation,
                         const Quaternion& end_orientation) {
                 check_numbers("start", start, ranges::finite);
                 check_numbers("end", end, ranges::finite);
                 return S{brush,
                          body,
                          {start, unit_quaternion("start_orientation_xyzw", start_orientation)},
                          {end, unit_quaternion("end_orientation_xyzw", end_orientation)}};
             }),
             py::arg("brush"), py::arg("body").none(false), py::arg("start"), py::arg("end"),
             py::arg("start_orientation_xyzw") = Quaternion::Identity(),
             py::arg("end_orientation_xyzw") = Quaternion::Identity(),
             "body: of body_for(). start and end [mm, physical], and the orientations there, tool\n"
             "axes to physical axes.")
        .def_readonly("brush", &S::brush)
        .def_property_readonly("body",
                               [](const S& s) { return std::const_pointer_cast<ToolBody>(s.body); })
        .def_property_readonly(
            "start", [](const S& s) { return s.from.position; }, "[mm, physical]")
        .def_property_readonly(
            "end", [](const S& s) { return s.to.position; }, "[mm, physical]")
        .def_property_readonly(
            "start_orientation_xyzw", [](const S& s) { return s.from.orientation; },
            "Unit quaternion, tool axes to physical axes.")
        .def_property_readonly(
            "end_orientation_xyzw", [](const S& s) { return s.to.orientation; },
            "Unit quaternion, tool axes to physical axes.");
}

}  // namespace

void bind_edits(py::module_& module) {
    bind_brushes(module);
    py::class_<edit::Stroke>(module, "Stroke", "A brush swept along a straight line.")
        .def(py::init([](const Brush& brush, const Vec3& start, const Vec3& end) {
                 check_numbers("start", start, ranges::finite);
                 check_numbers("end", end, ranges::finite);
                 return edit::Stroke{brush, start, end};
             }),
             py::arg("brush"), py::arg("start"), py::arg("end"), "start and end [mm, physical].")
        .def_readonly("brush", &edit::Stroke::brush)
        .def_readonly("start", &edit::Stroke::from, "[mm, physical]")
        .def_readonly("end", &edit::Stroke::to, "[mm, physical]");
    bind_bodies(module);
    bind_sweeps(module);
    py::class_<edit::Fill>(module, "Fill", "Sets all samples of a box to one value.")
        .def(py::init(&filled_box), py::arg("low"), py::arg("high"), py::arg("value"),
             "Corners (i, j, k), both in the box; value [data units].")
        .def_property_readonly("low", [](const edit::Fill& f) { return f.box.low; })
        .def_property_readonly("high", [](const edit::Fill& f) { return f.box.high; })
        .def_readonly("value", &edit::Fill::value,
                      "[data units] Rounded for whole numbers, and clamped to the samples' type.");
    py::class_<edit::Replace>(module, "Replace", "Puts another volume's samples into the grid.")
        .def(py::init([](const Index3& at, const Volume& samples) {
                 return edit::Replace{at, samples};
             }),
             py::arg("at"), py::arg("samples"), "at: index (i, j, k) of the first one.")
        .def_readonly("at", &edit::Replace::at)
        .def_readonly("samples", &edit::Replace::samples);
    py::class_<Editor>(module, "Editor",
                       "Applies edits to samples, with undo. One thread at a time.")
        .def(py::init([](const Volume& volume, std::size_t history_bytes) {
                 return std::make_unique<Editor>(std::make_shared<const Samples>(volume),
                                                 history_bytes);
             }),
             py::arg("volume"), py::arg("history_bytes") = std::size_t{512} << 20,
             "history_bytes: most that undo and redo keep.")
        .def(
            "apply",
            [](Editor& e, const Edit& edit, bool same_step) {
                return box_of(e.apply(edit, same_step ? EditStep::same : EditStep::own, ctrl_c()));
            },
            py::arg("edit"), py::arg("same_step") = false, py::call_guard<GilReleased>(),
            "The box of samples that changed, (low, high), or None. same_step: belongs to the\n"
            "last step of undo().")
        .def(
            "undo", [](Editor& e) { return box_of(e.undo()); },
            "The box of samples that changed, or None.")
        .def(
            "redo", [](Editor& e) { return box_of(e.redo()); },
            "The box of samples that changed, or None.")
        .def_property_readonly(
            "samples",
            [](const Editor& e) { return std::const_pointer_cast<Samples>(e.samples()); },
            "The current version: Samples, which do not change.")
        .def_property_readonly("undo_steps", &Editor::undo_steps)
        .def_property_readonly("redo_steps", &Editor::redo_steps);
}

}  // namespace palpate::python
