// A device `forcedimension` on a stand-in for the vendor's library, stepped in virtual time:
// opening it, pressing, and what it does within which time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>

#include "devices/forcedimension/forcedimension.hpp"
#include "devices/forcedimension/mock_dhd.hpp"
#include "devices/stepped_device.hpp"
#include "devices/vendor_library.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {

using namespace std::chrono_literals;
using support::any_scene;
using support::contains;
using support::message_of;
using support::MockDhd;
using support::MockDhdState;
using support::pass;

/// A stand-in that was just plugged in.
inline MockDhd* plugged_in(const char* path) {
    MockDhd* (*plug_in)() = nullptr;
    VendorLibrary({path}, "build it").need(plug_in, "mock_dhd");
    MockDhd* const mock = plug_in();
    const std::lock_guard lock(mock->mutex);
    mock->state = {};
    return mock;
}

class ForceDimension : public support::SteppedDevice {
  protected:
    void use(const char* library) {
        library_ = library;
        mock_ = plugged_in(library);
    }
    void SetUp() override { use(MOCK_DRD); }

    /// The stand-in looks after the device every 20 ms, so a change shows within this time; a force
    /// passes 20 ms later.
    static constexpr std::chrono::milliseconds soon{21}, felt{42};

    void step() override {
        device_->step();
        pass(250us);
    }
    std::unique_ptr<forcedimension::DhdDevice> open(const std::string& options = "",
                                                    double rate = 1000,
                                                    const OnProgress& progress = {}) {
        DeviceScene scene = any_scene(rate);
        scene.progress = progress;
        auto device =
            forcedimension::open(parse_device("forcedimension:library=" + library_ + options),
                                 scene, {&support::virtual_now, &support::pass_until});
        device_ = device.get();
        return device;
    }
    std::string refusal(const std::string& options = "") {
        return message_of<DeviceError>([&] { open(options); });
    }

    /// Of the stand-in, its lock held.
    template <class F>
    auto with(F act) const {
        const std::lock_guard lock(mock_->mutex);
        return act(mock_->state);
    }
    /// In our axes: x to the right, y up, z towards the person.
    Vec3 force() const {
        return with([](auto& dhd) { return Vec3(dhd.force[1], dhd.force[2], dhd.force[0]); });
    }
    bool becomes(Device& device, DeviceStatus status) {
        return within(soon, [&] { return device.read(0).status == status; });
    }
    bool has_no_problem(Device& device) {
        return within(soon, [&] { return device.problem().empty(); });
    }
    bool says(Device& device, const std::string& words) {
        return within(soon, [&] { return contains(device.problem(), words); });
    }
    /// Presses with this force until the device feels it.
    bool presses(Device& device, const Vec3& newtons = Vec3(1, 2, 0)) {
        return within(
            felt, [&] { return (force() - newtons).norm() < 1e-12; },
            [&] {
                device.write({newtons, Vec3::Zero()}, 0);
            });
    }
    /// [N m] in our axes.
    Vec3 torque() const {
        return with([](auto& dhd) { return Vec3(dhd.torque[1], dhd.torque[2], dhd.torque[0]); });
    }
    /// Presses and turns until the device feels both.
    bool turns(Device& device, const Vec3& newton_mm = Vec3(10, 20, 30)) {
        const Vec3 newtons(1, 2, 0);
        return within(
            felt,
            [&] {
                return (force() - newtons).norm() < 1e-12 &&
                       (1000 * torque() - newton_mm).norm() < 1e-9;
            },
            [&] {
                device.write({newtons, newton_mm}, 0);
            });
    }
    bool is_zero() const { return force().isZero(0) && torque().isZero(0); }
    /// No force from the next step on, for a while, whatever is asked for.
    bool stays_at_zero(Device& device) {
        return throughout(
            100ms, [&] { return is_zero(); },
            [&] {
                device.write({Vec3(1, 1, 1), Vec3(1, 1, 1)}, 0);
            });
    }
    /// Nothing is written any more: the force ends when the last one is older than 20 ms, not
    /// before.
    bool goes_to_zero_in_silence() {
        return throughout(20ms, [&] { return !is_zero(); }) &&
               within(250us, [&] { return is_zero(); });
    }
    long called(const std::string& name) const {
        return with(
            [&](auto& dhd) { return std::count(dhd.calls.begin(), dhd.calls.end(), name); });
    }

    forcedimension::DhdDevice* device_ = nullptr;
    std::string library_;
    MockDhd* mock_ = nullptr;
};

}  // namespace palpate::devices
