// A device `openhaptics` on the stand-in for the vendor's library, whose servo loop is stepped in
// virtual time.
#pragma once

#include <algorithm>
#include <memory>
#include <string>

#include "devices/openhaptics/mock_hd.hpp"
#include "devices/openhaptics/openhaptics.hpp"
#include "devices/vendor_device.hpp"

namespace palpate::devices {

using support::MockHdState;

class OpenHaptics : public VendorDevice<MockHdState> {
  protected:
    // For cases that all vendors share.
    static constexpr const char* library = MOCK_HD;
    static constexpr const char* lacking = MOCK_HD_LACKING;
    static constexpr const char* lacks = "hdUnschedule";
    static constexpr const char* install = "install 3D Systems' OpenHaptics";
    static constexpr const char* words_of_break = "Communication error (0x302)";
    static constexpr bool comes_back = false;
    static DeviceFinding find(const std::string& path) { return openhaptics::find(path); }

    /// A reading is stale after 20 ms, and a force passes 20 ms after a frame in which all is well.
    OpenHaptics()
        : VendorDevice("openhaptics", "mock_hd", {.step = 1ms, .soon = 21ms, .felt = 22ms}) {
        use(library);
        VendorLibrary({library}, "build it").need(frame_, "mock_hd_frame");
    }

    void step() override {
        frame_();
        pass(1ms);
    }
    std::unique_ptr<Device> open_for(const DeviceChoice& choice,
                                     const DeviceScene& scene) override {
        return openhaptics::open(choice, scene, {&support::virtual_now, &frames_until});
    }
    /// While the device sleeps, its driver does not.
    static void frames_until(std::int64_t ns) noexcept {
        while (support::virtual_now() < ns) {
            frame_();
            pass(1ms);
        }
    }
    Vec3 force() const override {
        return with([](auto& hd) { return Vec3(hd.force[0], hd.force[1], hd.force[2]); });
    }
    Vec3 torque() const override {
        return with([](auto& hd) { return Vec3(hd.torque[0], hd.torque[1], hd.torque[2]); });
    }
    bool is_open() const {
        return with([](auto& hd) { return hd.device_open; });
    }
    void break_connection(bool on) {
        if (on) with([](auto& hd) { hd.next_error = 0x302; });
    }
    void let_time_pass_by_itself() {
        with([](auto& hd) { hd.own_thread = true; });
    }
    long called(const std::string& name) const {
        return with([&](auto& hd) { return std::ranges::count(hd.calls, name); });
    }

  private:
    static inline void (*frame_)() = nullptr;
};

}  // namespace palpate::devices
