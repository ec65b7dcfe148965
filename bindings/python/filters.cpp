// Volumes from volumes: smoothing, sharpening, dequantization. All run without the GIL.
#include "palpate/filters/dequantize.hpp"

#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"

namespace palpate::python {
namespace {

using Unlocked = py::call_guard<GilReleased>;

Volume dequantized(const Volume& volume, int rounds, std::optional<int> coarsest,
                   std::optional<double> level, int threads, const ProgressFunction& progress) {
    filters::DequantizeOptions options{rounds, coarsest, level, threads, progress_of(progress)};
    const GilReleased unlocked;
    return filters::dequantized(volume, options);
}

void bind_terraces(py::module_& module) {
    py::class_<filters::Terraces>(module, "Terraces", "What rounding does to a volume's surfaces.")
        .def_readonly("level", &filters::Terraces::level, "Distance of levels [data units].")
        .def_readonly("mask", &filters::Terraces::mask, "There are two values only.")
        .def_readonly("labels", &filters::Terraces::labels,
                      "The values are so few whole numbers that they may be labels.")
        .def_readonly("share", &filters::Terraces::share,
                      "The part of the surfaces that are terraces, 0 to 1.")
        .def_readonly("tilt", &filters::Terraces::tilt,
                      "Mean angle between their normals and the smooth field's [degrees].")
        .def_property_readonly("wide", &filters::Terraces::wide, "Worth dequantizing.")
        .def_property_readonly("rounds", &filters::Terraces::rounds, "Rounds that suit them.")
        .def("__repr__", [](const filters::Terraces& t) {
            return py::str("Terraces(level={}, mask={}, labels={}, share={:.3g}, tilt={:.3g})")
                .format(t.level, t.mask, t.labels, t.share, t.tilt);
        });
}

}  // namespace

void bind_filters(py::module_& module) {
    bind_terraces(module);
    module.def(
        "smoothed",
        [](const Volume& volume, int passes, const ProgressFunction& progress) {
            const GilReleased unlocked;
            return smoothed(volume, passes, progress_of(progress));
        },
        py::arg("volume"), py::arg("passes") = 1, py::arg("progress") = py::none(),
        "The volume smoothed with the binomial kernel (1 2 1)/4 along each axis, `passes`\n"
        "times (0 to 64), as float32.");
    module.def(
        "sharpened",
        [](const Volume& volume, const ProgressFunction& progress) {
            const GilReleased unlocked;
            return sharpened(volume, progress_of(progress));
        },
        py::arg("volume"), py::arg("progress") = py::none(),
        "Samples minus an eighth of their discrete Laplacian, as float32: thin structures\n"
        "keep their height in the smooth field.");
    module.def(
        "level_of", [](const Volume& volume) { return filters::level_of(volume, ctrl_c()); },
        py::arg("volume"), Unlocked(),
        "The distance between the levels that samples lie on [data units]; None where they\n"
        "lie on none.");
    module.def(
        "terraces_of", [](const Volume& volume) { return filters::terraces_of(volume, ctrl_c()); },
        py::arg("volume"), Unlocked(),
        "What rounding does to the surfaces of a volume; None where data have no levels.");
    module.def(
        "dequantized", &dequantized, py::arg("volume"), py::arg("rounds") = 40,
        py::arg("coarsest") = py::none(), py::arg("level") = py::none(), py::arg("threads") = 0,
        py::arg("progress") = py::none(),
        "The smoothest float32 samples from which rounding makes the volume's own\n"
        "(docs/dequantize.md). rounds 1 to 1000; coarsest step [samples], a power of two to\n"
        "32; level [data units]; threads 0: all cores. The result does not depend on threads.");
}

}  // namespace palpate::python
