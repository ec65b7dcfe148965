// The servo with a device that is written in Python.
#include "palpate/servo.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>

#include "bindings/python/bindings.hpp"
#include "bindings/python/commands.hpp"
#include "bindings/python/python_device.hpp"
#include "bindings/python/renderer.hpp"
#include "bindings/python/without_gil.hpp"
#include "palpate/devices/last_resort.hpp"
#include "palpate/run/no_effect.hpp"

namespace palpate::python {
namespace {

/// A servo and the device that it runs; the device goes last.
struct DeviceServo {
    DeviceServo(Renderer renderer, std::unique_ptr<PythonDevice> its_device,
                const ServoSettings& settings)
        : python_device(std::move(its_device)),
          asked{renderer, {}},
          servo(Session{std::move(renderer), {}}, *python_device, settings),
          last_resort(*python_device) {}

    /// False if the device's thread goes on for good (PythonDevice::finish()).
    bool finish() {
        stopped = true;
        servo.stop();
        return python_device->finish();
    }
    void start() { servo.start(); }
    auto snapshot() const { return servo.snapshot(); }
    ServoReport report() const { return servo.report(); }
    auto& privileges() const { return servo.privileges(); }

    OwnProcess process;
    std::atomic<bool> stopped{false};
    std::unique_ptr<PythonDevice> python_device;
    Session asked;  ///< with all that was sent
    Servo servo;
    devices::LastResort last_resort;
};

using Held = std::shared_ptr<DeviceServo>;

/// Settings that were asked for are refused if the device cannot render them. Only the usual
/// stiffness is lowered.
void check_with(const DeviceLimits& limits, RendererSettings settings) {
    settings.device = smaller(settings.device, limits);
    double& stiffness = settings.force.stiffness;
    if (stiffness == ForceSettings{}.stiffness) {
        stiffness =
            std::min(stiffness, greatest_stiffness(settings.device, settings.force.damping));
    }
    check(settings);
}

Held make_servo(const SharedRenderer& renderer, const py::object& device, double rate,
                bool real_time, double device_rate) {
    ServoSettings settings;
    settings.rate = rate;
    settings.real_time = real_time;
    auto its_device = make_python_device(device, device_rate);
    Renderer own = renderer;  // with the GIL, as other threads may use it
    check_with(its_device->info().limits, own.settings);
    const GilReleased unlocked;
    return {new DeviceServo(std::move(own), std::move(its_device), settings),
            &destroy_session<DeviceServo>};
}

void send_to_servo(DeviceServo& s, const Sent& sent) {
    s.process.check();
    if (s.stopped) throw std::logic_error("the servo has stopped, so it carries out no commands");
    const Renderer& asked = s.asked.renderer;
    const Command command =
        command_of(sent, asked.field, asked.isovalue_without_layers.value_or(asked.proxy.isovalue),
                   asked.settings.force);
    run::refuse_without_effect(run::without_effect(asked.field.samples()),
                               {{"Moment", std::holds_alternative<command::Moment>(command)},
                                {"Speed", std::holds_alternative<command::Speed>(command)}});
    if (!s.servo.send(command)) {
        const py::object type = py::module_::import("palpate.errors").attr("QueueFull");
        PyErr_SetString(type.ptr(), "no room for another command: send fewer");
        throw py::error_already_set();
    }
    apply(s.asked, command);
}

}  // namespace

void bind_servo(py::module_& module) {
    py::class_<DeviceServo, Held> servo(
        module, "Servo",
        "A session that runs on a real-time thread of its own, with a device written in Python.\n"
        "The servo thread never takes the GIL. The device's functions run on another thread:\n"
        "info() -> DeviceInfo, read() -> DeviceReading, and, where there are, write(force [N],\n"
        "torque [N mm]) and close(). While Python does not come back to them readings become "
        "stale\n"
        "after 20 ms and there is no force. For devices by name, sequences and recordings use "
        "Run.");
    servo
        .def(py::init(&make_servo), py::arg("renderer"), py::arg("device"), py::kw_only(),
             py::arg("rate") = 1000.0, py::arg("real_time") = true, py::arg("device_rate") = 1000.0,
             "rate [Hz] 250 to 8000. device_rate [Hz]: how often the device is asked. The smaller\n"
             "one limits the stiffness.")
        .def("send", &send_to_servo, py::arg("command"),
             "A command of palpate.command, or ForceSettings, Friction, Penetrability,\n"
             "DeviceTransform or DeviceLimits. Never waits. Raises ValueError, QueueFull.")
        .def_property_readonly(
            "device_problem", [](const DeviceServo& s) { return s.python_device->problem(); },
            "What the device's functions raised or returned in place of what they have to, until\n"
            "they do as they should; usually empty.");
    add_session(servo);
}

}  // namespace palpate::python
