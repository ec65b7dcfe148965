// Named synthetic volumes and motions of a hand.
#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "palpate/scenes/motions.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::python {
namespace {

py::array_t<double> exact_at(const scenes::Scene& scene, const Doubles& points) {
    if (!scene.exact) {
        throw std::invalid_argument(scene.name + " has no analytic density");
    }
    return column(points_from(points, "points"), scene.exact);
}

std::pair<py::array_t<double>, py::array_t<double>> motion(const std::string& name,
                                                           const Field& field,
                                                           const io::Level& level,
                                                           const scenes::MotionSettings& settings) {
    const double isovalue = io::level_in(field.volume(), level);
    const auto samples =
        without_gil([&] { return scenes::make_motion(name, field, isovalue, settings, ctrl_c()); });
    return {column(samples, [](const scenes::HandSample& s) { return s.t; }),
            column(samples, [](const scenes::HandSample& s) { return s.position; })};
}

}  // namespace

void bind_scenes(py::module_& module) {
    using scenes::Scene;
    py::class_<Scene>(module, "Scene", "A synthetic volume, and what is known about it.")
        .def_readonly("name", &Scene::name)
        .def_property_readonly("volume", [](const Scene& s) { return s.volume; })
        .def_readonly("isovalue", &Scene::isovalue, "A good one to feel [data units].")
        .def_readonly("description", &Scene::description)
        .def("exact", &exact_at, py::arg("points"),
             "The analytic density [data units], shape (n,), at points [mm], shape (n, 3).\n"
             "ValueError where there is none.")
        .def(py::pickle(
            [](const Scene& s) {
                return py::make_tuple(s.name, s.volume.type(), s.volume.geometry());
            },
            [](const py::tuple& state) {
                const auto name = state[0].cast<std::string>();
                const auto type = state[1].cast<SampleType>();
                const auto grid = state[2].cast<Geometry>();
                const GilReleased unlocked;
                return scenes::make_volume(name, grid, type, ctrl_c());
            }))
        .def("__repr__", [](const Scene& s) {
            return py::str("Scene({!r}, {!r}, isovalue={:g})")
                .format(s.name, py::cast(s.volume), s.isovalue);
        });
    module.def(
        "scene",
        [](const std::string& name, std::optional<SampleType> type,
           const std::optional<Geometry>& geometry) {
            const GilReleased unlocked;
            return geometry ? scenes::make_volume(name, *geometry, type, ctrl_c())
                            : scenes::make_volume(name, type, ctrl_c());
        },
        py::arg("name"), py::arg("type") = py::none(), py::arg("geometry") = py::none(),
        "A synthetic volume: 'NAME' or 'NAME:WxHxD' of scene_names(), or NAME on a grid of yours.");
    module.def("scene_names", &scenes::volume_names, "The names of all synthetic volumes.");
    using M = scenes::MotionSettings;
    Record<M>(module, "MotionSettings", "Settings of motion().")
        .field("rate_hz", &M::rate_hz, {"Samples per second.", ranges::positive})
        .field("duration_s", &M::duration_s, {"[s]", ranges::not_negative})
        .field("speed_mm_s", &M::speed_mm_s, {"Never faster [mm/s].", ranges::positive})
        .field("depth_mm", &M::depth_mm, {"How deep the hand presses [mm].", ranges::not_negative})
        .field(
            "seed", &M::seed,
            {"Random seed of the start, the direction and the order of the motion.", ranges::any})
        .done();
    module.def("motion", &motion, py::arg("name"), py::arg("field"), py::arg("isovalue"),
               py::arg_v("settings", M{}, "MotionSettings()"),
               "A hand that looks for the surface itself: (time [s], shape (n,); position [mm,\n"
               "physical], shape (n, 3)). One of motion_names().");
    module.def("motion_names", &scenes::motion_names, "approach, press, slide, ...");
}

}  // namespace palpate::python
