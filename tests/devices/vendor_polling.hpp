// Waiting for a device of the vendors' kind in tests: until something is so, never for a time that
// a stalling machine could break.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

#include "palpate/device.hpp"
#include "palpate/devices/backend.hpp"
#include "support/fields.hpp"

namespace palpate::support {

/// A session that a device may be opened for; nothing is made of its volume.
inline devices::DeviceScene any_scene(double rate = 1000) {
    static const Field field(
        volume_of<float>(grid(cube(2)), [](const Index3& index) { return index[0]; }));
    return {field, 0.5, rate, [](const DeviceInfo&) { return DeviceTransform{}; }};
}

/// Until it holds; false if it did not within 10 s. Calls `between` before each look.
inline bool eventually(
    const std::function<bool()>& holds, const std::function<void()>& between = [] {}) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::chrono::steady_clock::now() < until) {
        between();
        if (holds()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
}

/// Whether it holds all the time for so long.
inline bool throughout(
    std::chrono::milliseconds time, const std::function<bool()>& holds,
    const std::function<void()>& between = [] {}) {
    const auto until = std::chrono::steady_clock::now() + time;
    while (std::chrono::steady_clock::now() < until) {
        between();
        if (!holds()) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

}  // namespace palpate::support
