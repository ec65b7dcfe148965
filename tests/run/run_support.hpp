// Servos that start on data, and waiting for what they feel.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "palpate/run/data.hpp"
#include "palpate/run/recorded_samples.hpp"
#include "support/eventually.hpp"
#include "support/scripted_device.hpp"

namespace palpate::run::test {

using namespace std::chrono_literals;

using support::comes_true;

inline LoadedVolume loaded(const std::string& name) {
    return load(source_named(name));
}

/// Waits until a run or a servo has rendered so many ticks from now on, however slow the machine
/// is.
template <class Live>
bool renders(const Live& live, int ticks) {
    const auto number = [&] {
        const auto now = live.snapshot();
        return now ? now->number : 0;
    };
    const auto before = number();
    return comes_true([&] { return number() > before + ticks; });
}

/// Starts a servo on `device`; `told` gets the history, if it is not null.
inline StartServo servo_on(Device& device, std::vector<Command>* told = nullptr) {
    return [&device, told](Session session, const std::vector<Command>& history) {
        if (told) *told = history;
        auto servo = std::make_unique<Servo>(std::move(session), device,
                                             ServoSettings{.rate = 1000, .real_time = false});
        servo->start();
        return servo;
    };
}

}  // namespace palpate::run::test
