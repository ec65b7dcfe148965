// A device that talks to a stand-in for the service, stepped in virtual time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "devices/haply/fake_service.hpp"
#include "devices/haply/haply.hpp"
#include "devices/haply/messages.hpp"
#include "devices/stepped_device.hpp"
#include "palpate/devices/devices.hpp"

namespace palpate::devices {

using namespace palpate::support;
using namespace std::chrono_literals;

class HaplyTest : public SteppedDevice {
  protected:
    static constexpr const char* id = "049D";
    const Vec3 push{1, 2, 3};           // [N, device axes]
    const Vec3 push_arrives{1, -3, 2};  // the same in service axes
    /// Of a service that answers at once: what has changed shows in the next answer, and a force
    /// passes 20 ms later.
    static constexpr std::chrono::microseconds soon{1000}, felt{22000};

    HaplyTest() {
        service.greet(snapshot({whole_device(id)}));
        service.answer(moved(id, Vec3(0.1, -0.2, 0.3)));
    }

    void step() override { device_->step(); }

    std::unique_ptr<haply::Inverse3> open(const std::string& options = "") {
        const DeviceChoice choice =
            parse_device("haply:host=127.0.0.1,port=4711" + (options.empty() ? "" : "," + options));
        auto device = haply::open(choice, any_scene(), {service.channel(), {}}, timing);
        device_ = device.get();
        return device;
    }

    /// What opening it says instead; empty if it opens.
    std::string refusal(const std::string& options = "") {
        try {
            open(options);
        } catch (const std::exception& error) {
            return error.what();
        }
        return {};
    }

    /// Writes the push once, as a servo does each millisecond.
    void press(Device& device) const { device.write({push, Vec3::Zero()}, 0); }

    bool becomes(Device& device, DeviceStatus status, Time time = soon) {
        return within(
            time, [&] { return device.read(0).status == status; }, [&] { press(device); });
    }
    bool says(const Device& device, const std::string& part, Time time = soon) {
        return within(time, [&] { return device.problem().find(part) != std::string::npos; });
    }
    /// Until the push arrives.
    bool is_pressed(Device& device, Time time = felt) {
        const std::size_t since = service.forces().size();
        return within(
            time,
            [&] {
                const auto& forces = service.forces();
                return std::find(forces.begin() + static_cast<std::ptrdiff_t>(since), forces.end(),
                                 push_arrives) != forces.end();
            },
            [&] { press(device); });
    }
    /// Whether nothing arrives of a force that is written from now on; 100 ms.
    bool nothing_is_felt(Device& device) {
        const std::size_t since = service.forces().size();
        const bool zero = throughout(
            100ms,
            [&] { return service.forces().size() == since || service.forces().back().isZero(0); },
            [&] {
                device.write({Vec3(4, 0, 0), Vec3::Zero()}, 0);
            });
        return zero && service.forces().size() > since + 10;
    }

    const Timing timing{&virtual_now, &pass_until};
    FakeService service;
    haply::Inverse3* device_ = nullptr;
};

}  // namespace palpate::devices
