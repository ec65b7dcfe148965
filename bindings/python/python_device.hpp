// A device that is written in Python. Its functions run on a thread of their own, which takes the
// GIL. The servo thread exchanges readings and forces with that thread through a Link and never
// waits for it.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "bindings/python/casters.hpp"
#include "bindings/python/own_process.hpp"
#include "bindings/python/without_gil.hpp"
#include "devices/own_device.hpp"
#include "palpate/devices/error.hpp"

namespace palpate::python {

class PythonFunctions;

class PythonDevice final : public devices::OwnDevice {
  public:
    explicit PythonDevice(std::shared_ptr<PythonFunctions> functions);
    /// finish(), with or without the GIL.
    ~PythonDevice() override;

    /// Ends the thread, after a last write of zero and close(). Any thread, any number of times,
    /// without the GIL; from the device's own functions it only asks for the end. False if they do
    /// not return within two seconds: then another thread has written the zero.
    bool finish();
    /// Not to its own thread, which would wait for itself.
    bool is_stopping() const noexcept override {
        return !is_own_thread() && OwnDevice::is_stopping();
    }

  private:
    std::shared_ptr<PythonFunctions> functions_;
    std::mutex finish_;
    bool left_behind_ = false;  // under finish_
};

/// The device, asked `rate` [Hz] times a second. `device` has read() and may have
/// write(force, torque) and close(). With the GIL. Throws py::type_error and std::invalid_argument
/// for what is no device, DeviceError for an object that serves another session.
std::unique_ptr<PythonDevice> make_python_device(const py::object& device, double rate);

/// What a device's function returned. Throws std::invalid_argument for an object of another class.
template <class T>
T returned_by(const char* function, const py::object& returned) {
    if (py::isinstance<T>(returned)) return returned.cast<T>();
    throw std::invalid_argument(std::string(function) + " has to return a " +
                                std::string(py::str(py::type::of<T>().attr("__name__"))) +
                                ", not " + std::string(py::repr(returned)));
}

// An `Owner` of a device has `process`, `python_device` (null: another kind of device) and
// finish(), which stops the session and then the device; false as PythonDevice::finish().

/// Ends a session. Throws devices::DeviceError if the device's functions do not return.
template <class Owner>
void stop_session(Owner& owner) {
    owner.process.check();
    if (owner.finish()) return;
    throw devices::DeviceError("the device: " + owner.python_device->problem() +
                               ": the session has ended, and the thread that hangs is left "
                               "behind");
}

/// What all sessions offer.
template <class Owner>
void add_session(py::class_<Owner, std::shared_ptr<Owner>>& kind) {
    using Unlocked = py::call_guard<GilReleased>;
    const auto start = [](const py::object& self) {
        auto& owner = self.cast<Owner&>();
        owner.process.check();
        stop_at_exit<Owner>(self, [](Owner& running) { stop_session(running); });
        const GilReleased unlocked;
        owner.start();
    };
    kind.def("start", start, "Starts the servo. May be called once.")
        .def("stop", &stop_session<Owner>, Unlocked(),
             "Zero force, for good, and the end of all threads: a device in Python is written a\n"
             "last zero and closed. Raises DeviceError if its functions do not return within 2 s:\n"
             "another thread then writes the zero, and the error says whether that failed, too.\n"
             "Raises RuntimeError in a forked child, which has no servo.")
        .def("snapshot", &Owner::snapshot, "The newest tick, a Snapshot; None before the first.")
        .def("report", &Owner::report, "The ServoReport of all ticks so far.")
        .def_property_readonly(
            "privileges", [](const Owner& o) { return std::vector<std::string>(o.privileges()); },
            "A sentence for each privilege of real time. After start().")
        .def("__enter__",
             [start](const py::object& self) {
                 start(self);
                 return self;
             })
        .def("__exit__", [](Owner& owner, const py::args& error) {
            if constexpr (requires { owner.edited; }) {
                if (!error[0].is_none()) owner.edited->failed = true;
            }
            const GilReleased unlocked;
            if (owner.process.is_here()) stop_session(owner);
        });
}

/// Whoever lets go last. Where that are the device's own functions, another thread of Python does
/// it, which waits for them.
template <class Owner>
void destroy_session(Owner* owner) {
    if (!owner->process.is_here()) return;
    if (!owner->python_device || !owner->python_device->is_own_thread()) {
        return destroy_without_gil(owner);
    }
    const py::gil_scoped_acquire gil;
    try {
        owner->finish();
        const py::cpp_function later([owner] { destroy_session(owner); });
        py::module_::import("threading")
            .attr("Thread")(py::arg("target") = later, py::arg("daemon") = false)
            .attr("start")();
    } catch (const std::exception&) {  // Python ends
    }
}

}  // namespace palpate::python
