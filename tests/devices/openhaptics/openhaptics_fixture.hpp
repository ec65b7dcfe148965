// A device `openhaptics` on the stand-in for the vendor's library: opening it, pressing, and
// waiting for what it does.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "devices/openhaptics/mock_hd.hpp"
#include "devices/openhaptics/openhaptics.hpp"
#include "devices/vendor_library.hpp"
#include "devices/vendor_polling.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {

using namespace std::chrono_literals;
using support::any_scene;
using support::contains;
using support::eventually;
using support::message_of;
using support::MockHd;
using support::throughout;

/// Without its folder, which systems write in their own ways.
inline std::string name_of(const char* library) {
    return std::filesystem::path(library).filename().string();
}

class OpenHaptics : public testing::Test {
  protected:
    void SetUp() override {
        const VendorLibrary library({MOCK_HD}, "build it");
        MockHd* (*mock)() = nullptr;
        void (*reset)() = nullptr;
        library.need(mock, "mock_hd");
        library.need(reset, "mock_hd_reset");
        hd_ = mock();
        reset();
    }

    static std::unique_ptr<Device> open(const std::string& options = "", double rate = 1000) {
        const std::string text = "openhaptics:library=" + std::string(MOCK_HD) + options;
        return open_openhaptics(parse_device(text), any_scene(rate));
    }
    static std::string refusal(const std::string& options = "") {
        return message_of<DeviceError>([&] { open(options); });
    }

    /// Of the stand-in, its lock held.
    template <class F>
    auto with(F use) const {
        const std::lock_guard lock(hd_->mutex);
        return use(*hd_);
    }
    Vec3 force() const {
        return with([](MockHd& hd) { return Vec3(hd.force[0], hd.force[1], hd.force[2]); });
    }
    /// [mN m]
    Vec3 torque() const {
        return with([](MockHd& hd) { return Vec3(hd.torque[0], hd.torque[1], hd.torque[2]); });
    }
    bool becomes(Device& device, DeviceStatus status) const {
        return eventually([&] { return device.read(0).status == status; });
    }
    bool has_no_problem(Device& device) const {
        return eventually([&] { return device.problem().empty(); });
    }
    /// Presses with this force until the device feels it.
    bool presses(Device& device, const Vec3& newtons) const {
        return eventually([&] { return (force() - newtons).norm() < 1e-12; },
                          [&] {
                              device.write({newtons, Vec3::Zero()}, 0);
                          });
    }
    /// Presses and turns until the device feels both.
    bool turns(Device& device, const Vec3& newton_mm = Vec3(10, 20, 30)) const {
        const Vec3 newtons(1, 0.5, 0);
        return eventually(
            [&] {
                return (force() - newtons).norm() < 1e-12 && (torque() - newton_mm).norm() < 1e-9;
            },
            [&] {
                device.write({newtons, newton_mm}, 0);
            });
    }
    /// No force for a while, whatever is asked for.
    bool stays_at_zero(Device& device) const {
        return throughout(
            100ms, [&] { return force().isZero(0) && torque().isZero(0); },
            [&] {
                device.write({Vec3(1, 1, 1), Vec3(1, 1, 1)}, 0);
            });
    }
    bool goes_to_zero(Device& device) const {
        const auto press = [&] { device.write({Vec3(1, 1, 1), Vec3(1, 1, 1)}, 0); };
        return eventually([&] { return force().isZero(0) && torque().isZero(0); }, press) &&
               stays_at_zero(device);
    }

    MockHd* hd_ = nullptr;
};

}  // namespace palpate::devices
