// The thread of a device that is written in Python.
#include "bindings/python/python_device.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <optional>

namespace palpate::python {
namespace {

constexpr std::int64_t rest = 50'000'000;  // [ns]

/// Empty, or the problem in one line: what the device's function raised.
template <class Work>
std::string tried(const std::string& function, Work&& work) {
    try {
        work();
        return {};
    } catch (const py::error_already_set& error) {
        const std::string text = error.what();  // with a traceback
        const auto end = std::min(text.find('\n'), text.find(": <EMPTY MESSAGE>"));
        return "the device's " + function + " raised " + text.substr(0, end);
    } catch (const std::exception& error) {
        return "the device's " + function + ": " + error.what();
    }
}

std::string write_to(const py::object& device, const Wrench& wrench) {
    return tried("write()", [&] {
        if (!py::hasattr(device, "write")) return;
        called(py::object(device.attr("write")), wrench.force, wrench.torque);
    });
}

/// A spring is sampled no faster than the device is asked, and acts later by the exchange with the
/// thread that asks.
DeviceInfo at_rate(DeviceInfo info, double rate) {
    info.limits.rate = std::min(info.limits.rate, rate);
    info.limits.delay += devices::exchange_delay(1 / rate);
    return info;
}

/// It may outlive the PythonDevice.
std::unique_ptr<py::object> held_by_thread(const py::object& device) {
    const py::gil_scoped_acquire gil;
    return std::make_unique<py::object>(device);
}

}  // namespace

std::unique_ptr<PythonDevice> make_python_device(const py::object& device, double rate) {
    if (!py::hasattr(device, "info") || !py::hasattr(device, "read")) {
        throw py::type_error("a device needs the functions info() and read()");
    }
    const auto info = returned_by<DeviceInfo>("info()", device.attr("info")());
    return std::make_unique<PythonDevice>(device, info, rate);
}

PythonDevice::PythonDevice(py::object self, DeviceInfo info, double rate)
    : self_(std::move(self)), info_(at_rate(std::move(info), rate)), rate_(rate) {
    if (!(rate >= 1 && rate <= 8000)) {
        throw std::invalid_argument("a device in Python is asked 1 to 8000 times a second");
    }
    check(info_);
    check(info_.limits);
    claim_.emplace(
        "the device " + std::string(py::str(py::type::of(self_).attr("__name__"))) + " (object " +
        std::string(py::str(py::int_(py::module_::import("builtins").attr("id")(self_)))) + ")");
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
    const std::string stuck = "its read() or write() does not return";
    set_problem(stuck);
    // On a thread of its own, as it may hang as well.
    std::promise<std::string> promise;
    std::future<std::string> zero = promise.get_future();
    std::thread([device = held_by_thread(self_), written = std::move(promise)]() mutable {
        std::string problem;
        {
            const py::gil_scoped_acquire gil;
            problem = write_to(*device, {});
            device.reset();
        }
        written.set_value(std::move(problem));
    }).detach();
    if (zero.wait_for(longest) != std::future_status::ready) {
        set_problem(stuck + ", not even with a force of zero");
        return false;
    }
    const std::string unwritten = zero.get();
    set_problem(stuck +
                (unwritten.empty() ? ", and a force of zero was written" : ", and " + unwritten));
    return false;
}

PythonDevice::~PythonDevice() {
    std::optional<GilReleased> unlocked;  // its thread takes the GIL before it ends
    if (PyGILState_Check()) unlocked.emplace();
    finish();
    if (thread_.joinable()) thread_.join();
    const py::gil_scoped_acquire gil;
    self_ = py::object();
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
    while (!ending_) {
        step();
        // Steps that are late are left out, not made up for.
        next = std::max(next + period, steady_clock::now());
        std::this_thread::sleep_until(next);
    }
    end();
    claim_.reset();
    ended_ = true;
}

/// While one of the functions raises the device has a fault, so there is no force. It lasts for so
/// many ticks that the servo sees it: afterwards the force begins with the ramp.
void PythonDevice::step() {
    const py::gil_scoped_acquire gil;
    DeviceReading reading;
    const std::string unread = tried("read()", [&] {
        reading = returned_by<DeviceReading>("read()", called(py::object(self_.attr("read"))));
    });
    const std::int64_t now = devices::monotonic_ns();
    if (!unread.empty()) {
        set_problem(unread);  // before the servo sees the fault
        rests_until_ = now + rest;
    }
    const bool rests = now < rests_until_;
    // Taken after the GIL was waited for, so that an old force is not sent, and before the servo
    // knows this reading: after a silence the first force is that of a servo that has released it.
    const Wrench newest = link_.wrench(now);
    if (rests) {
        link_.report(DeviceStatus::fault, now);
    } else {
        link_.report(reading, now);
    }
    const std::string unwritten = write_to(self_, rests ? Wrench{} : newest);
    if (!unwritten.empty()) rests_until_ = now + rest;
    set_problem(unread.empty() ? unwritten : unread);
}

void PythonDevice::end() {
    constexpr int tries = 3;  // of a device that refuses its last zero
    const py::gil_scoped_acquire gil;
    std::string problem = write_to(self_, {});
    for (int i = 1; i < tries && !problem.empty(); ++i) problem = write_to(self_, {});
    for (int i = 0; i < 2; ++i) link_.wrench(devices::monotonic_ns());  // the zero is out
    const std::string open = tried("close()", [&] {
        if (py::hasattr(self_, "close")) called(py::object(self_.attr("close")));
    });
    if (problem.empty()) problem = open;
    if (!problem.empty()) set_problem(problem);
}

}  // namespace palpate::python
