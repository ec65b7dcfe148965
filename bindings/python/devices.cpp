// Devices: which there are, their readings, and those that are written in Python.
#include "palpate/devices/devices.hpp"

#include <cmath>

#include "bindings/python/bindings.hpp"
#include "bindings/python/progress.hpp"
#include "bindings/python/record.hpp"

namespace palpate::python {
namespace {

std::vector<py::dict> found_devices() {
    const auto findings = without_gil([] { return devices::find_devices(ctrl_c()); });
    std::vector<py::dict> list;
    for (const devices::DeviceFinding& f : findings) {
        list.push_back(py::dict(py::arg("name") = f.name, py::arg("found") = f.found,
                                py::arg("what") = f.what, py::arg("missing") = f.missing,
                                py::arg("options") = f.options));
    }
    return list;
}

/// Throws std::invalid_argument.
void turn(DeviceReading& reading, const Quaternion& to) {
    reading.orientation = unit_quaternion("orientation_xyzw", to).toRotationMatrix();
}

}  // namespace

void bind_devices(py::module_& module) {
    using I = DeviceInfo;
    Record<I>(module, "DeviceInfo",
              "Properties of a device. Axes: x to the right, y up, z towards the person.")
        .field("name", &I::name, "Of the backend.")
        .field("model", &I::model, "As the device reports it.")
        .field("limits", &I::limits, "DeviceLimits: never exceeded by a servo.")
        .field("stiffness", &I::stiffness, {"[N/mm] it is rated for", ranges::not_negative})
        .field("workspace_low", &I::workspace_low, {"[device mm]", ranges::finite})
        .field("workspace_high", &I::workspace_high,
               {"[device mm] corners of the usable box", ranges::finite})
        .field("renders_force", &I::renders_force, "False: position only.")
        .field("renders_torque", &I::renders_torque, "False: torque is ignored.")
        .field("has_orientation", &I::has_orientation, "Readings turn.")
        .field("has_gripper", &I::has_gripper, "Readings have an opening.")
        .field("buttons", &I::buttons, {"Number of buttons.", {0, 32, false, "from 0 to 32"}})
        .done();
    using R = DeviceReading;
    Record<R>(module, "DeviceReading", "The newest measurement of a device.")
        .field("position", &R::position, {"[device mm]", ranges::finite})
        .property(
            "orientation_xyzw", [](const R& r) { return Quaternion(r.orientation); }, &turn,
            "Unit quaternion, tool axes to device axes.")
        .field("buttons", &R::buttons, {"Bit b is set while button b is held.", ranges::any})
        .field("opening", &R::opening,
               {"[rad] of a gripper, 0: closed. None: it has none.", ranges::finite})
        .field("age", &R::age, {"[s] since it was measured; below 0 or inf: stale.", ranges::any})
        .field("status", &R::status,
               "'starting', 'ready', 'uncalibrated', 'stale', 'lost', 'fault', 'finished'.")
        .done();
    module.def("find_devices", &found_devices,
               "Looks for every kind of device: dicts with name, found, what, missing, options.");
    module.def(
        "fit_workspace",
        [](const Geometry& geometry, const DeviceInfo& device, Facing facing) {
            check(device);
            return fit_workspace(geometry, device, facing);
        },
        py::arg("geometry"), py::arg("device"), py::arg("facing") = Facing::anterior,
        "The DeviceTransform that fits the whole grid into the device's workspace.");
}

}  // namespace palpate::python
