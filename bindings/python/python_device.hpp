// A device that is written in Python. Its functions run on a thread of their own, which takes the
// GIL. The servo thread exchanges readings and forces with that thread through a Link and never
// waits for it.
#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "bindings/python/casters.hpp"
#include "bindings/python/own_process.hpp"
#include "bindings/python/without_gil.hpp"
#include "devices/claim.hpp"
#include "devices/linked_device.hpp"
#include "palpate/devices/error.hpp"

namespace palpate::python {

/// The device, asked `rate` [Hz] times a second. With the GIL. Throws py::type_error and
/// std::invalid_argument for what is no device.
class PythonDevice;
std::unique_ptr<PythonDevice> make_python_device(const py::object& device, double rate);

/// What a device's function returned. Throws std::invalid_argument for an object of another class.
template <class T>
T returned_by(const char* function, const py::object& returned) {
    if (py::isinstance<T>(returned)) return returned.cast<T>();
    throw std::invalid_argument(std::string(function) + " has to return a " +
                                std::string(py::str(py::type::of<T>().attr("__name__"))) +
                                ", not " + std::string(py::repr(returned)));
}

class PythonDevice final : public devices::LinkedDevice {
  public:
    /// `self` has read() and may have write(force, torque) and close(). Starts the thread, which
    /// calls them `rate` [Hz] times a second. With the GIL. Throws std::invalid_argument, and
    /// DeviceError for an object that serves another session.
    PythonDevice(py::object self, DeviceInfo info, double rate);
    /// finish(), and waits for the thread however long it takes. Not on that thread.
    ~PythonDevice() override;

    /// Ends the thread, after a last write of zero and close(). Any thread, any number of times,
    /// without the GIL; from the device's own functions it only asks for the end. False if they do
    /// not return within two seconds: then this thread has written the zero, and the device's still
    /// uses this object.
    bool finish();
    bool is_own_thread() const { return std::this_thread::get_id() == asking_.load(); }

    DeviceInfo info() const override { return info_; }
    /// What its functions raised.
    std::string problem() const override;
    /// Not to its own thread, which would wait for itself.
    bool is_stopping() const noexcept override { return !is_own_thread() && link_.stopping(); }

  private:
    void run();
    void step();
    void end();
    void set_problem(const std::string& problem);

    py::object self_;  // used with the GIL
    const DeviceInfo info_;
    const double rate_;
    mutable std::mutex mutex_;  // of problem_
    std::string problem_;
    std::int64_t rests_until_ = 0;  // [ns, monotonic] the device's thread's: a fault until then
    std::atomic<bool> ending_{false}, ended_{false};
    bool left_behind_ = false;             // under finish_
    std::atomic<std::thread::id> asking_;  // the device's thread
    std::mutex finish_;
    std::optional<devices::Claim> claim_;  // until the thread ends
    std::thread thread_;                   // last: it uses all of the above
};

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
        .def("__exit__", [](Owner& owner, const py::args&) {
            const GilReleased unlocked;
            if (owner.process.is_here()) stop_session(owner);
        });
}

/// Whoever lets go last. Where that are the device's own functions, another thread of Python does
/// it, which waits for them. One that never ends keeps the owner for good.
template <class Owner>
void destroy_session(Owner* owner) {
    if (!owner->process.is_here()) return;
    if (owner->python_device && owner->python_device->is_own_thread()) {
        const py::gil_scoped_acquire gil;
        try {
            owner->finish();
            const py::cpp_function later([owner] { destroy_session(owner); });
            py::module_::import("threading")
                .attr("Thread")(py::arg("target") = later, py::arg("daemon") = false)
                .attr("start")();
        } catch (const std::exception&) {  // Python ends
        }
        return;
    }
    const auto end = [owner] {
        if (owner->finish()) delete owner;
    };
    if (!PyGILState_Check()) return end();
    const GilReleased unlocked;
    end();
}

}  // namespace palpate::python
