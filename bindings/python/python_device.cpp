// The thread of a device that is written in Python.
#include "bindings/python/python_device.hpp"

#include <chrono>

namespace palpate::python {

PythonDevice::PythonDevice(py::object self, DeviceInfo info, double rate)
    : self_(std::move(self)), info_(std::move(info)), rate_(rate) {
    if (!(rate >= 1 && rate <= 8000)) {
        throw std::invalid_argument("a device in Python is asked 1 to 8000 times a second");
    }
    check(info_.limits);
    thread_ = std::thread([this] { run(); });
}

bool PythonDevice::finish() {
    using namespace std::chrono;
    constexpr milliseconds longest{2000}, between{1};
    link_.stop();
    ending_ = true;
    if (is_own_thread()) return true;
    const std::lock_guard lock(finish_);
    const auto until = steady_clock::now() + longest;
    while (!left_behind_ && !ended_ && steady_clock::now() < until) {
        std::this_thread::sleep_for(between);
    }
    if (ended_) {
        if (thread_.joinable()) thread_.join();
        return true;
    }
    if (left_behind_) return false;
    left_behind_ = true;
    set_problem("its read() or write() does not return");
    const py::gil_scoped_acquire gil;
    try {
        write_zero();
    } catch (const std::exception& error) {
        set_problem(std::string("its read() or write() does not return, and write() raised ") +
                    error.what());
    }
    return false;
}

PythonDevice::~PythonDevice() {
    finish();
    if (thread_.joinable()) thread_.join();
    const py::gil_scoped_acquire gil;
    self_ = py::object();
}

void PythonDevice::write_zero() {
    const Vec3 none = Vec3::Zero();
    if (py::hasattr(self_, "write")) self_.attr("write")(none, none);
}

std::string PythonDevice::problem() const {
    const std::lock_guard lock(mutex_);
    return problem_;
}

void PythonDevice::set_problem(const std::string& problem) {
    const std::lock_guard lock(mutex_);
    problem_ = problem;
}

void PythonDevice::run() {
    asking_ = std::this_thread::get_id();
    using namespace std::chrono;
    const auto period = duration_cast<steady_clock::duration>(duration<double>(1 / rate_));
    auto next = steady_clock::now();
    while (!ending_ && step()) {
        // Steps that are late are left out, not made up for.
        next = std::max(next + period, steady_clock::now());
        std::this_thread::sleep_until(next);
    }
    end();
    ended_ = true;
}

/// False once a function has raised: there is no force then.
bool PythonDevice::step() {
    const py::gil_scoped_acquire gil;
    try {
        const auto reading = self_.attr("read")().cast<DeviceReading>();
        link_.report(reading, devices::monotonic_ns());
        // Taken after the GIL was waited for, so that an old force is not sent.
        const Wrench wrench = link_.wrench(devices::monotonic_ns());
        if (py::hasattr(self_, "write")) self_.attr("write")(wrench.force, wrench.torque);
        return true;
    } catch (const std::exception& error) {
        link_.stop();
        link_.report(DeviceStatus::fault, devices::monotonic_ns());
        set_problem(std::string("the device's function raised ") + error.what());
        return false;
    }
}

void PythonDevice::end() {
    const py::gil_scoped_acquire gil;
    try {
        write_zero();
        for (int i = 0; i < 2; ++i) link_.wrench(devices::monotonic_ns());  // the zero is out
        if (py::hasattr(self_, "close")) self_.attr("close")();
    } catch (const std::exception& error) {
        set_problem(std::string("the device's function raised ") + error.what());
    }
}

}  // namespace palpate::python
