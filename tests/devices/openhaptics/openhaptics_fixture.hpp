// A device `openhaptics` on the stand-in for the vendor's library, whose servo loop is stepped in
// virtual time: opening it, pressing, and what it does within which time.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "devices/openhaptics/mock_hd.hpp"
#include "devices/openhaptics/openhaptics.hpp"
#include "devices/stepped_device.hpp"
#include "devices/vendor_library.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {

using namespace std::chrono_literals;
using support::any_scene;
using support::contains;
using support::message_of;
using support::MockHd;
using support::pass;

/// Without its folder, which systems write in their own ways.
inline std::string name_of(const char* library) {
    return std::filesystem::path(library).filename().string();
}

class OpenHaptics : public support::SteppedDevice {
  protected:
    /// A reading is stale after 20 ms, and a force passes 20 ms after a frame in which all is well.
    static constexpr std::chrono::milliseconds soon{21}, felt{22};

    void SetUp() override {
        const VendorLibrary library({MOCK_HD}, "build it");
        MockHd* (*mock)() = nullptr;
        void (*reset)() = nullptr;
        library.need(mock, "mock_hd");
        library.need(reset, "mock_hd_reset");
        library.need(frame_, "mock_hd_frame");
        hd_ = mock();
        reset();
    }

    static std::unique_ptr<Device> open(const std::string& options = "", double rate = 1000,
                                        const OnProgress& progress = {}) {
        const std::string text = "openhaptics:library=" + std::string(MOCK_HD) + options;
        DeviceScene scene = any_scene(rate);
        scene.progress = progress;
        return openhaptics::open(parse_device(text), scene, {&support::virtual_now, &frames_until});
    }
    void step() override {
        frame_();
        pass(1ms);
    }
    /// While the device sleeps, its driver does not.
    static void frames_until(std::int64_t ns) noexcept {
        while (support::virtual_now() < ns) {
            frame_();
            pass(1ms);
        }
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
    bool becomes(Device& device, DeviceStatus status) {
        return within(soon, [&] { return device.read(0).status == status; });
    }
    bool has_no_problem(Device& device) {
        return within(soon, [&] { return device.problem().empty(); });
    }
    /// Presses with this force until the device feels it.
    bool presses(Device& device, const Vec3& newtons, Time time = felt) {
        return within(
            time, [&] { return (force() - newtons).norm() < 1e-12; },
            [&] {
                device.write({newtons, Vec3::Zero()}, 0);
            });
    }
    /// Presses and turns until the device feels both.
    bool turns(Device& device, const Vec3& newton_mm = Vec3(10, 20, 30), Time time = felt) {
        const Vec3 newtons(1, 0.5, 0);
        return within(
            time,
            [&] {
                return (force() - newtons).norm() < 1e-12 && (torque() - newton_mm).norm() < 1e-9;
            },
            [&] {
                device.write({newtons, newton_mm}, 0);
            });
    }
    bool is_zero() const { return force().isZero(0) && torque().isZero(0); }
    /// No force from the next frame on, for a while, whatever is asked for.
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
               within(1ms, [&] { return is_zero(); });
    }

    MockHd* hd_ = nullptr;
    static inline void (*frame_)() = nullptr;
};

}  // namespace palpate::devices
