// Subjects and contestants of the experiments, by name.
#include "bindings/python/bindings.hpp"
#include "evaluation/contestants.hpp"
#include "evaluation/subject.hpp"

namespace palpate::python {

void bind_evaluation(py::module_& module) {
    using evaluation::Subject;
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
}

}  // namespace palpate::python
