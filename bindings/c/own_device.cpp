// A device whose reading and writing are callbacks of the C interface's caller.
#include "bindings/c/own_device.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>

#include "bindings/c/handles.hpp"
#include "bindings/c/runtimes.hpp"
#include "bindings/c/structs.hpp"
#include "devices/own_device.hpp"

namespace palpate::c {
namespace {

DeviceInfo info_from(const palpate_own_device& asked) {
    DeviceInfo info;
    info.name = name_of(asked);
    info.model = asked.model ? asked.model : info.name;
    info.limits.maximum_force = asked.maximum_force;
    info.limits.maximum_torque = asked.maximum_torque;
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
    return devices::at_rate(info, asked.rate);
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

/// Two devices of an application have two contexts, or functions of their own.
std::string claim_of(const palpate_own_device& own) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "' (read %p, context %p)",
                  reinterpret_cast<void*>(own.read), own.context);
    return "the device '" + name_of(own) + text.data();
}

class Callbacks final : public devices::OwnFunctions {
  public:
    Callbacks(const palpate_own_device& asked, const DeviceInfo& info)
        : OwnFunctions(info, asked.rate, claim_of(asked)), callbacks_(asked) {}

    std::string problem() const override {
        const char* const trouble = trouble_;
        return trouble ? "the application's device '" + info_.name + "' " + trouble : "";
    }

  private:
    void begin() noexcept override {
        devices::prepare_device_thread();
        let_runtimes_stop_this_thread();
        calls_back = true;
    }
    void exchange() noexcept override;
    void close() noexcept override;
    void fail(DeviceStatus status, const char* trouble) noexcept {
        trouble_ = trouble;
        link_.report(status, devices::monotonic_ns());
    }

    const palpate_own_device callbacks_;
    std::atomic<const char*> trouble_{nullptr};  // why the newest reading counts for nothing
};

void Callbacks::exchange() noexcept {
    try {
        auto reading = sized<palpate_reading>();
        bool lost = callbacks_.read(&reading, callbacks_.context) != 0;
        auto wrench = sized<palpate_wrench>();
        const Wrench newest = link_.wrench(devices::monotonic_ns());
        put(newest.force, wrench.force);
        put(newest.torque, wrench.torque);
        lost |= callbacks_.write(&wrench, callbacks_.context) != 0;
        if (lost) return fail(DeviceStatus::lost, "reports that it is lost");
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
            return fail(DeviceStatus::fault,
                        "gives a position or an orientation that is not finite");
        }
        trouble_ = nullptr;
        link_.report(measured, devices::monotonic_ns());
    } catch (...) {
        fail(DeviceStatus::fault, "threw an exception");
    }
}

void Callbacks::close() noexcept {
    exchange();  // after the stop, so it sends the zero
    try {
        if (callbacks_.close) callbacks_.close(callbacks_.context);
    } catch (...) {  // NOLINT(bugprone-empty-catch): nobody is left to be told
    }
}

}  // namespace

std::string name_of(const palpate_own_device& asked) {
    return asked.name ? asked.name : "own";
}

std::unique_ptr<Device> make_own_device(const palpate_own_device& asked) {
    palpate_own_device own = asked;
    if (own.rate == 0) own.rate = 1000;
    const DeviceInfo info = info_from(own);
    check(own, info);
    return std::make_unique<devices::OwnDevice>(std::make_shared<Callbacks>(own, info));
}

}  // namespace palpate::c
