// A device that talks to the stand-in service, and patience.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "devices/haply/haply.hpp"
#include "devices/haply/messages.hpp"
#include "devices/haply/mock_service.hpp"

namespace palpate::devices {

using namespace palpate::support;
using namespace std::chrono_literals;

/// True as soon as the condition holds; gives up after 10 s.
inline bool until(const auto& condition) {
    const auto give_up = std::chrono::steady_clock::now() + 10s;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > give_up) return false;
        std::this_thread::sleep_for(500us);
    }
    return true;
}

class HaplyTest : public ::testing::Test {
  protected:
    static constexpr const char* id = "049D";
    const Vec3 push{1, 2, 3};           // [N, device axes]
    const Vec3 push_arrives{1, -3, 2};  // the same in service axes

    HaplyTest() {
        service.greet(snapshot({whole_device(id)}));
        service.answer(moved(id, Vec3(0.1, -0.2, 0.3)));
    }

    std::unique_ptr<Device> open(const std::string& options = "") {
        const DeviceChoice choice =
            parse_device("haply:host=127.0.0.1,port=" + std::to_string(service.port()) +
                         (options.empty() ? "" : "," + options));
        return open_haply(choice, {field, 0.5, 1000, {}});
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

    /// Writes the push once and looks how the device is, as a servo does each millisecond.
    DeviceStatus press(Device& device) const {
        device.write({push, Vec3::Zero()}, 0);
        return device.read(0).status;
    }

    bool until_status(Device& device, DeviceStatus status) const {
        return until([&] { return press(device) == status; });
    }

    /// What is wrong is told just after the status.
    bool until_problem(const Device& device, const std::string& part) const {
        return until([&] { return device.problem().find(part) != std::string::npos; });
    }

    /// Until a force has arrived since the service had seen `since` of them.
    bool until_pressed(Device& device, std::size_t since = 0) const {
        return until([&] {
            press(device);
            const auto forces = service.forces();
            for (std::size_t i = since; i < forces.size(); ++i) {
                if (forces[i] == push_arrives) return true;
            }
            return false;
        });
    }

    /// Whether nothing arrives of a force that is written from now on. One message may have been in
    /// the making.
    bool nothing_is_felt(Device& device) const {
        const std::size_t now = service.forces().size();
        const Vec3 later(4, 0, 0);
        const bool went_on = until([&] {
            device.write({later, Vec3::Zero()}, 0);
            const auto forces = service.forces();
            return forces.size() > now + 10 && forces.back().isZero(0);
        });
        return went_on && std::ranges::count(service.forces(), later) <= 1;
    }

    MockService service;
    const Field field{Volume(Geometry{.size = {2, 2, 2}}, std::vector<float>(8, 0.0F))};
};

}  // namespace palpate::devices
