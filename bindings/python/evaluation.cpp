// Subjects and contestants of the experiments, by name, and the hand that explores.
#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "evaluation/contestants.hpp"
#include "evaluation/exploring_hand.hpp"
#include "evaluation/subject.hpp"

namespace palpate::python {
namespace {

using evaluation::Subject;

py::dict explore(const Subject& subject, evaluation::ExploringHand hand,
                 const std::optional<std::pair<double, double>>& wanted) {
    evaluation::TunedHand tuned;
    {
        const py::gil_scoped_release unlocked;
        if (wanted) {
            tuned = evaluation::tuned_hand(subject, hand, {wanted->first, wanted->second});
        } else {
            tuned = {evaluation::explore(subject, hand), {}, hand};
        }
    }
    std::vector<Vec3> hips;
    std::vector<std::int64_t> first;
    for (const evaluation::Trajectory& one : tuned.trajectories) {
        first.push_back(std::ssize(hips));
        hips.insert(hips.end(), one.begin(), one.end());
    }
    return py::dict(py::arg("hips") = array_from(std::move(hips)),
                    py::arg("first") = array_from(std::move(first)),
                    py::arg("speed_mm_s") = tuned.behaviour.speed_mm_s,
                    py::arg("constrained_share") = tuned.behaviour.constrained_share,
                    py::arg("depth_mm") = tuned.hand.depth_mm);
}

void bind_explore(py::module_& module) {
    module.def(
        "explore",
        [](const Field& field, double isovalue, const std::string& name, double speed,
           double touching, double depth, int trajectories, double seconds, std::uint64_t seed,
           const std::optional<std::pair<double, double>>& wanted) {
            return explore({name, field, isovalue},
                           {.speed_mm_s = speed,
                            .touching = touching,
                            .depth_mm = depth,
                            .trajectories = trajectories,
                            .trajectory_s = seconds,
                            .seed = seed},
                           wanted);
        },
        py::arg("field"), py::arg("isovalue"), py::kw_only(), py::arg("name") = "the volume",
        py::arg("speed_mm_s") = 50.0, py::arg("touching") = 0.6, py::arg("depth_mm") = 0.5,
        py::arg("trajectories") = 20, py::arg("trajectory_s") = 5.0, py::arg("seed") = 1,
        py::arg("wanted") = py::none(),
        "A simulated hand at 1 kHz that explores free space, comes back to the surface and slides "
        "along\n"
        "it, again and again: hips and first as for follow_each(). speed_mm_s: its mean; touching: "
        "the\n"
        "part of its time that it means to touch; depth_mm: below the surface. wanted: (mean "
        "speed, "
        "share\n"
        "of updates in contact), to which speed and touching are tuned; speed_mm_s and "
        "constrained_share\n"
        "say how near it comes, and depth_mm how deep it presses then. Raises ValueError for a "
        "level "
        "that\n"
        "nothing meets, which calls the volume `name`.");
}

}  // namespace

void bind_evaluation(py::module_& module) {
    py::class_<Subject>(module, "Subject", "A volume for an experiment, with a level to feel.")
        .def_readonly("name", &Subject::name)
        .def_property_readonly("field", [](const Subject& s) { return s.field; })
        .def_readonly("isovalue", &Subject::isovalue, "[data units]")
        .def_readonly("note", &Subject::note)
        .def("__repr__", [](const Subject& s) {
            return py::str("Subject({!r}, isovalue={:g})").format(s.name, s.isovalue);
        });
    module.def(
        "subject",
        [](const std::string& text, const std::optional<std::string>& contestant) {
            Subject subject = evaluation::subject_from(text);
            if (!contestant) return subject;
            return evaluation::as_felt_by(evaluation::contestant(*contestant), std::move(subject));
        },
        py::arg("text"), py::arg("contestant") = py::none(),
        py::call_guard<py::gil_scoped_release>(),
        "'synthetic:NAME[:WxHxD]' or a file or folder, '@ISOVALUE' behind it: 'head.nrrd@500'.\n"
        "With a contestant, the field that it feels. Raises ValueError, InputError.");
    module.def(
        "contestants",
        [] {
            std::vector<std::string> names;
            for (const auto& contestant : evaluation::contestants())
                names.push_back(contestant.name);
            return names;
        },
        "What experiments compare: all methods on the linear field, and 'smooth'.");
    bind_explore(module);
}

}  // namespace palpate::python
