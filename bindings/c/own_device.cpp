// The thread of a caller's device: read, write, read, ... at a steady rate. The servo only ever
// meets the newest reading and the newest force.
#include "bindings/c/own_device.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <optional>

#include "bindings/c/handles.hpp"
#include "bindings/c/runtimes.hpp"
#include "bindings/c/structs.hpp"
#include "devices/claim.hpp"
#include "devices/linked_device.hpp"

namespace palpate::c {
namespace {

/// How long the end of a device waits for its thread.
constexpr std::chrono::milliseconds longest_end{500};

/// Why the newest reading counts for nothing.
enum class Trouble : std::uint8_t { none, lost, no_pose, threw };

DeviceInfo info_from(const palpate_own_device& asked) {
    DeviceInfo info;
    info.name = name_of(asked);
    info.model = asked.model ? asked.model : info.name;
    info.limits.maximum_force = asked.maximum_force;
    info.limits.maximum_torque = asked.maximum_torque;
    info.limits.rate = std::min(info.limits.rate, asked.rate);
    info.limits.delay = devices::exchange_delay(1 / asked.rate);
    if (asked.stiffness != 0) info.stiffness = asked.stiffness;
    if (asked.physical_damping != 0) info.limits.physical_damping = asked.physical_damping;
    const Vec3 low = vec3(asked.workspace_low), high = vec3(asked.workspace_high);
    if (!low.isZero(0) || !high.isZero(0)) {
        info.workspace_low = low;
        info.workspace_high = high;
    }
    info.renders_torque = asked.maximum_torque > 0;
    info.has_orientation = asked.has_orientation != 0;
    info.has_gripper = asked.has_gripper != 0;
    info.buttons = asked.buttons;
    return info;
}

void check(const palpate_own_device& asked, const DeviceInfo& info) {
    if (!asked.read || !asked.write) throw std::invalid_argument("own.read or own.write is null");
    if (!(asked.rate >= 50 && asked.rate <= 8000)) {
        throw std::invalid_argument("own.rate: 50 to 8000 Hz, or 0 for 1000");
    }
    if (!(asked.maximum_force > 0)) {
        throw std::invalid_argument(
            "own.maximum_force: give what the device can take [N], above 0");
    }
    try {
        palpate::check(info);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(std::string("own.") + error.what());
    }
    palpate::check(info.limits);
}

palpate_own_device with_defaults(palpate_own_device asked) {
    if (asked.rate == 0) asked.rate = 1000;
    return asked;
}

/// Two devices of an application have two contexts, or functions of their own.
std::string claim_of(const palpate_own_device& own) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "' (read %p, context %p)",
                  reinterpret_cast<void*>(own.read), own.context);
    return "the device '" + name_of(own) + text.data();
}

}  // namespace

std::string name_of(const palpate_own_device& asked) {
    return asked.name ? asked.name : "own";
}

/// What the thread uses: it owns this as well, so that a callback that hangs may outlive the run.
class OwnDevice::Served final : public devices::LinkedDevice {
  public:
    explicit Served(const palpate_own_device& asked)
        : callbacks_(with_defaults(asked)), info_(info_from(callbacks_)) {
        check(callbacks_, info_);
        claim_.emplace(claim_of(asked));
    }

    DeviceInfo info() const override { return info_; }
    std::string problem() const override;

    /// The thread's: until quit(), a last exchange, which sends the zero, and close().
    void run() noexcept;
    void quit() noexcept { quit_ = true; }
    bool has_ended() const noexcept { return ended_; }
    /// The run is gone, and the thread goes on.
    void leave() {
        const std::lock_guard lock(claiming_);
        if (claim_) claim_->leave();
    }

  private:
    void exchange() noexcept;

    const palpate_own_device callbacks_;
    const DeviceInfo info_;
    std::mutex claiming_;
    std::optional<devices::Claim> claim_;  // until the thread ends
    std::atomic<Trouble> trouble_{Trouble::none};
    std::atomic<bool> quit_{false}, ended_{false};
};

OwnDevice::OwnDevice(const palpate_own_device& asked)
    : served_(std::make_shared<Served>(asked)), thread_([served = served_] { served->run(); }) {}

OwnDevice::~OwnDevice() {
    served_->stop();
    served_->quit();
    const auto latest = std::chrono::steady_clock::now() + longest_end;
    while (!served_->has_ended() && std::chrono::steady_clock::now() < latest) {
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    if (served_->has_ended()) {
        thread_.join();
    } else {
        served_->leave();
        thread_.detach();
    }
}

DeviceInfo OwnDevice::info() const {
    return served_->info();
}

std::string OwnDevice::problem() const {
    return served_->problem();
}

DeviceReading OwnDevice::read(double time) {
    return served_->read(time);
}

void OwnDevice::write(const Wrench& wrench, double time) {
    served_->write(wrench, time);
}

void OwnDevice::stop() noexcept {
    served_->stop();
}

bool OwnDevice::is_stopping() const noexcept {
    return served_->is_stopping();
}

std::string OwnDevice::Served::problem() const {
    const std::string device = "the application's device '" + info_.name + "' ";
    switch (trouble_.load()) {
        case Trouble::lost:
            return device + "reports that it is lost";
        case Trouble::no_pose:
            return device + "gives a position or an orientation that is not finite";
        case Trouble::threw:
            return device + "threw an exception";
        default:
            return {};
    }
}

void OwnDevice::Served::run() noexcept {
    devices::prepare_device_thread();
    let_runtimes_stop_this_thread();
    calls_back = true;
    const auto period = static_cast<std::int64_t>(1e9 / callbacks_.rate);  // [ns]
    std::int64_t next = devices::monotonic_ns();
    // Asked before the exchange: the last one comes after the stop, so it sends the zero.
    for (bool last = false; !last;) {
        last = quit_;
        exchange();
        next = std::max(next + period, devices::monotonic_ns() - period);
        if (!last) devices::sleep_until(next);
    }
    try {
        if (callbacks_.close) callbacks_.close(callbacks_.context);
    } catch (...) {  // NOLINT(bugprone-empty-catch): nobody is left to be told
    }
    const std::lock_guard lock(claiming_);
    claim_.reset();
    ended_ = true;
}

void OwnDevice::Served::exchange() noexcept {
    try {
        auto reading = sized<palpate_reading>();
        bool lost = callbacks_.read(&reading, callbacks_.context) != 0;
        auto wrench = sized<palpate_wrench>();
        const Wrench newest = link_.wrench(devices::monotonic_ns());
        put(newest.force, wrench.force);
        put(newest.torque, wrench.torque);
        lost |= callbacks_.write(&wrench, callbacks_.context) != 0;
        if (lost) {
            trouble_ = Trouble::lost;
            return link_.report(DeviceStatus::lost, devices::monotonic_ns());
        }
        const bool known = reading.status >= 0 && reading.status <= PALPATE_DEVICE_FINISHED;
        DeviceReading measured;
        measured.position = vec3(reading.position);
        measured.orientation = quaternion(reading.orientation).toRotationMatrix();
        measured.buttons = reading.buttons;
        measured.age = reading.age;
        if (info_.has_gripper) measured.opening = reading.opening;
        measured.status = known ? static_cast<DeviceStatus>(reading.status) : DeviceStatus::fault;
        if (measured.status == DeviceStatus::ready &&
            !(measured.position.allFinite() && measured.orientation.allFinite())) {
            trouble_ = Trouble::no_pose;
            return link_.report(DeviceStatus::fault, devices::monotonic_ns());
        }
        trouble_ = Trouble::none;
        link_.report(measured, devices::monotonic_ns());
    } catch (...) {
        trouble_ = Trouble::threw;
        link_.report(DeviceStatus::fault, devices::monotonic_ns());
    }
}

}  // namespace palpate::c
