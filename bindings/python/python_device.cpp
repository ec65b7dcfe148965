// The functions of a device that is written in Python.
#include "bindings/python/python_device.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <optional>
#include <utility>

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

constexpr std::chrono::milliseconds longest_end{2000};

}  // namespace

class PythonFunctions final : public devices::OwnFunctions {
  public:
    /// With the GIL.
    PythonFunctions(py::object device, const DeviceInfo& info, double rate)
        : OwnFunctions(info, rate,
                       "the device " + std::string(py::str(py::type::of(device).attr("__name__"))) +
                           " (object " +
                           std::to_string(reinterpret_cast<std::uintptr_t>(device.ptr())) + ")"),
          self_(std::move(device)) {}
    ~PythonFunctions() override {
        const GilTaken gil;
        self_ = py::object();
    }

    /// What its functions raised.
    std::string problem() const override {
        const std::lock_guard lock(mutex_);
        return problem_;
    }
    void set_problem(const std::string& problem) {
        const std::lock_guard lock(mutex_);
        problem_ = problem;
    }
    /// Any thread: what became of it, for the end of a sentence.
    std::string write_zero() {
        const GilTaken gil;
        const std::string problem = write_to(self_, {});
        return problem.empty() ? "a force of zero was written" : problem;
    }

  private:
    void exchange() override;
    void close() override;

    py::object self_;           // used with the GIL
    mutable std::mutex mutex_;  // of problem_
    std::string problem_;
    std::int64_t rests_until_ = 0;  // [ns, monotonic] the thread's: a fault until then
};

std::unique_ptr<PythonDevice> make_python_device(const py::object& device, double rate) {
    if (!py::hasattr(device, "info") || !py::hasattr(device, "read")) {
        throw py::type_error("a device needs the functions info() and read()");
    }
    const auto given = returned_by<DeviceInfo>("info()", device.attr("info")());
    if (!(rate >= 1 && rate <= 8000)) {
        throw std::invalid_argument("a device in Python is asked 1 to 8000 times a second");
    }
    const DeviceInfo info = devices::at_rate(given, rate);
    check(info);
    check(info.limits);
    return std::make_unique<PythonDevice>(std::make_shared<PythonFunctions>(device, info, rate));
}

PythonDevice::PythonDevice(std::shared_ptr<PythonFunctions> functions)
    : OwnDevice(functions), functions_(std::move(functions)) {}

PythonDevice::~PythonDevice() {
    std::optional<GilReleased> unlocked;  // its thread takes the GIL before it ends
    if (PyGILState_Check()) unlocked.emplace();
    finish();
}

bool PythonDevice::finish() {
    using namespace std::chrono_literals;
    if (is_own_thread()) {
        end(0ms);
        return true;
    }
    const std::lock_guard lock(finish_);
    if (end(left_behind_ ? 0ms : longest_end)) return true;
    if (std::exchange(left_behind_, true)) return false;
    const std::string stuck = "its read() or write() does not return, ";
    functions_->set_problem(stuck + "not even with a force of zero");
    // On a thread of its own, as it may hang as well.
    std::packaged_task<std::string()> task([to = functions_] { return to->write_zero(); });
    std::future<std::string> zero = task.get_future();
    std::thread(std::move(task)).detach();
    if (zero.wait_for(longest_end) == std::future_status::ready) {
        functions_->set_problem(stuck + "and " + zero.get());
    }
    return false;
}

/// While one of the functions raises the device has a fault, so there is no force. It lasts for so
/// many ticks that the servo sees it: afterwards the force begins with the ramp.
void PythonFunctions::exchange() {
    const GilTaken gil;
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

void PythonFunctions::close() {
    constexpr int tries = 3;  // of a device that refuses its last zero
    const GilTaken gil;
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
