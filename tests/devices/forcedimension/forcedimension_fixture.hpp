// A device `forcedimension` on a stand-in for the vendor's library, stepped in virtual time.
#pragma once

#include <algorithm>
#include <memory>
#include <string>

#include "devices/forcedimension/forcedimension.hpp"
#include "devices/forcedimension/mock_dhd.hpp"
#include "devices/vendor_device.hpp"

namespace palpate::devices {

using support::MockDhdState;

class ForceDimension : public VendorDevice<MockDhdState> {
  protected:
    // For cases that all vendors share.
    static constexpr const char* library = MOCK_DRD;
    static constexpr const char* lacking = MOCK_DHD_LACKING;
    static constexpr const char* lacks = "dhdGetStatus";
    static constexpr const char* install = "install Force Dimension's SDK";
    static constexpr const char* words_of_break =
        "no connection to the device (communication error)";
    static constexpr bool comes_back = true;
    static DeviceFinding find(const std::string& path) { return forcedimension::find(path); }

    /// The stand-in looks after the device every 20 ms, so a change shows within this time; a force
    /// passes 20 ms later.
    ForceDimension()
        : VendorDevice("forcedimension", "mock_dhd", {.step = 250us, .soon = 21ms, .felt = 42ms}) {
        use(library);
    }

    void step() override {
        device_->step();
        pass(250us);
    }
    std::unique_ptr<Device> open_for(const DeviceChoice& choice,
                                     const DeviceScene& scene) override {
        auto device =
            forcedimension::open(choice, scene, {&support::virtual_now, &support::pass_until});
        device_ = device.get();
        return device;
    }
    Vec3 force() const override {
        return with([](auto& dhd) { return Vec3(dhd.force[1], dhd.force[2], dhd.force[0]); });
    }
    Vec3 torque() const override {
        return with([](auto& dhd) {
            return Vec3(1000 * Vec3(dhd.torque[1], dhd.torque[2], dhd.torque[0]));
        });
    }
    bool is_open() const {
        return with([](auto& dhd) { return dhd.is_open; });
    }
    void break_connection(bool on) {
        with([&](auto& dhd) { dhd.position_error = on ? 2 : 0; });
    }
    void let_time_pass_by_itself() {}
    long called(const std::string& name) const {
        return with([&](auto& dhd) { return std::ranges::count(dhd.calls, name); });
    }

  private:
    forcedimension::DhdDevice* device_ = nullptr;
};

}  // namespace palpate::devices
