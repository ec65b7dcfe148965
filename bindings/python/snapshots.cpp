// Snapshots and reports of a live session.
#include "bindings/python/arrays.hpp"
#include "bindings/python/bindings.hpp"
#include "bindings/python/record.hpp"
#include "palpate/servo.hpp"

namespace palpate::python {
namespace {

py::dict dict_of(const LatencySummary& s) {
    return py::dict(py::arg("count") = s.count, py::arg("p50") = s.p50, py::arg("p99") = s.p99,
                    py::arg("p999") = s.p999, py::arg("max") = s.max);
}

using Column = py::array_t<double>;

std::tuple<Column, Column, Column> contacts_of(const Snapshot& snapshot) {
    const std::vector<ToolContact> contacts(snapshot.contacts.begin(),
                                            snapshot.contacts.begin() + snapshot.contact_count);
    return {column(contacts, [](const ToolContact& c) { return c.place; }),
            column(contacts, [](const ToolContact& c) { return c.normal; }),
            column(contacts, [](const ToolContact& c) { return c.pressure; })};
}

void bind_report(py::module_& module) {
    using R = ServoReport;
    const auto summary = [](LatencySummary R::*member) {
        return [member](const R& report) { return dict_of(report.*member); };
    };
    py::class_<R>(module, "ServoReport",
                  "Counts and times of the loop: dicts of count, p50, p99, p999 and max [ns].")
        .def_readonly("ticks", &R::ticks)
        .def_readonly("missed", &R::missed, "Ticks that did not happen when they were due.")
        .def_readonly("overruns", &R::overruns, "Ticks that took too long: no force.")
        .def_readonly("unrecorded", &R::unrecorded, "Events that a recording lost.")
        .def_property_readonly("period", summary(&R::period), "From tick to tick.")
        .def_property_readonly("lateness", summary(&R::lateness), "Woken after its time.")
        .def_property_readonly("work", summary(&R::work), "From waking to the end, wall clock.")
        .def_property_readonly("compute", summary(&R::compute), "The same, CPU time.")
        .def_property_readonly(
            "worst_cause", [](const R& r) { return std::string(name_of(r.worst.cause)); },
            "What most of the worst tick's time was spent on.")
        .def("__repr__", [](const R& r) {
            return py::str("ServoReport(ticks={}, missed={}, overruns={})")
                .format(r.ticks, r.missed, r.overruns);
        });
}

}  // namespace

void bind_snapshots(py::module_& module) {
    using S = Snapshot;
    using T = SessionTick;
    py::class_<S> snapshot(module, "Snapshot", "The newest tick of a live session, and its state.");
    const auto add = [&](auto... part) { add_part(snapshot, part...); };
    add("tick", "Tick", &S::session, &T::tick);
    add("device", "DeviceReading", &S::session, &T::device);
    add("transform", "DeviceTransform in use.", &S::session, &T::transform);
    add("frozen", "", &S::session, &T::frozen);
    add("clutched", "", &S::session, &T::clutched);
    add("moment", "[s] of a sequence", &S::session, &T::moment);
    add("version", "Of the samples.", &S::session, &T::version);
    add("number", "Of the tick, from 0.", &S::number);
    add("missed", "Deadlines so far.", &S::missed);
    add("speed", "At which a sequence is played.", &S::speed);
    add("stiffness", "[N/mm] in use", &S::stiffness);
    add("normal", "At the SCP, unit, out of the solid, physical axes.", &S::normal);
    add("penetrability_on", "", &S::penetrability_on);
    add("forces_on", "", &S::forces_on);
    snapshot
        .def_property_readonly("contacts", &contacts_of,
                               "Of a tool: (place [mm], normal, pressure [mm]); pressure 0: near.")
        .def("__repr__", [](const S& s) {
            return py::str("Snapshot(number={}, {!r})").format(s.number, py::cast(s.session.tick));
        });
    bind_report(module);
}

}  // namespace palpate::python
