// A fixture for devices that are stepped in virtual time, with the servo that writes forces to
// them.
#pragma once

#include <gtest/gtest.h>

#include <chrono>

#include "palpate/device.hpp"
#include "palpate/devices/backend.hpp"
#include "support/fields.hpp"
#include "support/virtual_time.hpp"

namespace palpate::support {

/// A session that a device may be opened for; nothing is made of its volume.
inline devices::DeviceScene any_scene(double rate = 1000) {
    static const Field field =
        linear_field(volume_of<float>(grid(cube(2)), [](const Index3& index) { return index[0]; }));
    return {field, 0.5, rate, [](const DeviceInfo&) { return DeviceTransform{}; }};
}

class SteppedDevice : public testing::Test {
  protected:
    using Time = std::chrono::nanoseconds;

    /// One step of the device, and the time until the next one.
    virtual void step() = 0;

    /// Steps until it holds, at least once; false if it did not within this time. Calls `between`
    /// before each step.
    template <class Holds, class Between>
    bool within(Time time, const Holds& holds, const Between& between) {
        const std::int64_t begun = virtual_now();
        do {
            between();
            step();
            if (holds()) return true;
        } while (passed_since(begun) < time);
        return false;
    }
    template <class Holds>
    bool within(Time time, const Holds& holds) {
        return within(time, holds, [] {});
    }
    /// Whether it holds after each step for so long.
    template <class Holds, class Between>
    bool throughout(Time time, const Holds& holds, const Between& between) {
        return !within(
            time, [&] { return !holds(); }, between);
    }
    template <class Holds>
    bool throughout(Time time, const Holds& holds) {
        return throughout(time, holds, [] {});
    }
};

}  // namespace palpate::support
