// Fields, and queries of their values.
#include <cmath>

#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"
#include "palpate/field.hpp"
#include "palpate/proxy.hpp"
#include "palpate/run/no_effect.hpp"

namespace palpate::python {
namespace {

py::array_t<double> values_at(const Field& field, const Doubles& points) {
    const std::vector<Vec3> at = points_from(points, "points");
    std::vector<double> values(at.size());
    {
        ReportedItems slices(ctrl_c(), at.size(), updates_in_slice);
        const GilReleased unlocked;
        for (std::size_t i = 0; i < at.size(); ++i, slices.done()) {
            values[i] = at[i].hasNaN() ? std::nan("") : value_at(field, at[i]);
        }
    }
    return array_from(std::move(values));
}

py::array_t<double> gradients_at(const Field& field, const Doubles& points) {
    std::vector<Vec3> at = points_from(points, "points");
    {
        ReportedItems slices(ctrl_c(), at.size(), updates_in_slice);
        const GilReleased unlocked;
        for (Vec3& point : at) {
            slices.done();
            point = point.hasNaN() ? Vec3::Constant(std::nan("")) : gradient_at(field, point);
        }
    }
    return array_from(std::move(at));
}

std::optional<std::pair<Vec3, Vec3>> ray(const Field& field, const io::Level& level,
                                         const Vec3& from, const Vec3& to) {
    if (!from.allFinite() || !to.allFinite()) {
        throw std::invalid_argument("the ends of a ray have to be finite");
    }
    const RayHit hit = cast_ray(field, io::level_in(field.volume(), level), from, to);
    if (!hit.hit) return std::nullopt;
    return std::pair(hit.point, hit.normal);
}

using Moments = std::vector<std::pair<double, Volume>>;

std::shared_ptr<Samples> samples_from(const Moments& moments, double period) {
    if (moments.size() < 2) {
        run::refuse_without_effect({{{"period"}, "a single frame does not repeat"}},
                                   {{"period", period != 0}});
    }
    std::vector<Frame> frames;
    for (const auto& [time, volume] : moments) frames.push_back({time, volume});
    return std::make_shared<Samples>(std::move(frames), period);
}

/// For pickling: times and volumes, with all edits.
Moments moments_of(const Samples& samples) {
    if (samples.resident()) {
        throw py::type_error(
            "samples that are read while they are felt cannot be pickled: pickle the address of "
            "the store");
    }
    if (samples.bricks()) return {{0, flattened(samples, samples.moment_at(0))}};
    Moments moments;
    for (const Frame& frame : samples.frames()) moments.emplace_back(frame.time, frame.volume);
    return moments;
}

void bind_samples(py::module_& module) {
    py::class_<Samples, std::shared_ptr<Samples>> samples(
        module, "Samples",
        "One version of the numbers on a grid: a volume with its edits, or the frames of a\n"
        "sequence. Versions do not change and share what is equal.");
    copied_as_itself(samples)
        .def(py::init<Volume>(), py::arg("volume"))
        .def(py::init(&samples_from), py::arg("frames"), py::arg("period") = 0.0,
             "Frames as pairs (time [s], Volume), times rising. With a period [s] they repeat.")
        .def_property_readonly("geometry", &Samples::geometry, py::return_value_policy::copy)
        .def_property_readonly("minimum", &Samples::minimum, "[data units]")
        .def_property_readonly("maximum", &Samples::maximum, "[data units]")
        .def_property_readonly("edited", [](const Samples& s) { return s.bricks() != nullptr; })
        .def_property_readonly(
            "times",
            [](const Samples& self) {
                std::vector<double> times;
                for (const Frame& frame : self.frames()) times.push_back(frame.time);
                return array_from(std::move(times));
            },
            "Times of the frames [s].")
        .def(
            "volume",
            [](const Samples& self, double time) {
                check_numbers("time", time, ranges::finite);
                run::refuse_without_effect(run::without_effect(self), {{"time", time != 0}});
                return flattened(self, self.moment_at(time), ctrl_c());
            },
            py::arg("time") = 0.0, py::call_guard<GilReleased>(),
            "As one Volume, with all edits, at a time of a sequence [s].")
        .def(py::pickle(
            [](const Samples& self) { return py::make_tuple(moments_of(self), self.period()); },
            [](const py::tuple& state) {
                const auto moments = state[0].cast<Moments>();
                return moments.size() == 1 ? std::make_shared<Samples>(moments.front().second)
                                           : samples_from(moments, state[1].cast<double>());
            }));
}

}  // namespace

void bind_fields(py::module_& module) {
    bind_samples(module);
    py::class_<Field> field(
        module, "Field",
        "What is felt: samples continued over all of space, and which side is solid.");
    copied_as_itself(field)
        .def(py::init([](const Volume& volume, Solid solid, std::optional<double> background,
                         Interpolation interpolation) {
                 return Field(volume, solid, background, interpolation);
             }),
             py::arg("volume"), py::arg("solid") = Solid::above, py::arg("background") = py::none(),
             py::arg("interpolation") = Interpolation::cubic,
             "solid: 'above' or 'below' the isovalue. background [data units] is the density\n"
             "outside the grid, by default the volume's minimum ('below': its maximum).\n"
             "interpolation: 'cubic' (smooth) or 'linear' (of the paper).")
        .def(py::init([](const std::shared_ptr<Samples>& samples, Solid solid,
                         std::optional<double> background, Interpolation interpolation) {
                 return Field(samples, solid, background, interpolation);
             }),
             py::arg("samples").none(false), py::arg("solid") = Solid::above,
             py::arg("background") = py::none(), py::arg("interpolation") = Interpolation::cubic)
        .def_property_readonly("geometry", &Field::geometry, py::return_value_policy::copy)
        .def_property_readonly("volume", &Field::volume, py::return_value_policy::copy,
                               "Before all edits; of a sequence its first frame.")
        .def_property_readonly("solid", &Field::solid)
        .def_property_readonly("interpolation", &Field::interpolation)
        .def_property_readonly("background", &Field::background, "[data units]")
        .def_property_readonly("range", &Field::range,
                               "Largest minus smallest density, background included [data units].")
        .def(
            "value", &values_at, py::arg("points"),
            "Density [data units], shape (n,), at physical points [mm], shape (n, 3). NaN where a\n"
            "coordinate is NaN.")
        .def("gradient", &gradients_at, py::arg("points"),
             "Gradient [data units / mm], physical axes, shape (n, 3), at points [mm], (n, 3).")
        .def("cast_ray", &ray, py::arg("isovalue"), py::arg("start"), py::arg("end"),
             "Where a straight segment [mm, physical] first meets the isosurface: (point [mm],\n"
             "unit normal out of the solid), or None.")
        .def(py::pickle(
            [](const Field& f) {
                return py::make_tuple(std::const_pointer_cast<Samples>(f.shared_samples()),
                                      f.solid(), f.background(), f.interpolation(), f.time());
            },
            [](const py::tuple& state) {
                Field f(state[0].cast<std::shared_ptr<Samples>>(), state[1].cast<Solid>(),
                        state[2].cast<double>(), state[3].cast<Interpolation>());
                f.set_time(state[4].cast<double>());
                return f;
            }))
        .def("__repr__", [](const Field& f) {
            return py::str("Field({!r}, solid={!r}, background={:g}, interpolation={!r})")
                .format(py::cast(f.volume()), enum_name(f.solid()), f.background(),
                        enum_name(f.interpolation()));
        });
}

}  // namespace palpate::python
