// Servo: keeps the smaller of the settings and of the device's declared limits, at the start, for
// commands, and for a device that learns its limits when it connects.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "palpate/servo.hpp"
#include "support/press.hpp"
#include "support/scripted_device.hpp"
#include "support/stepped_servo.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr double limit_rounding = 1 + 1e-12;

/// Settings of an application that assumes a device of 20 N and does not copy the device's limits.
RendererSettings careless() {
    RendererSettings settings;
    settings.device.maximum_force = 20;
    settings.force.limit = 20;
    settings.force.stiffness = 4.9;
    settings.force.ramp = 0.02;
    return settings;
}

Session session_of(const RendererSettings& settings) {
    return {make_renderer(ramp_field(), 30, settings), {}};
}

/// Presses 5 mm into the ramp's level 30 and rests there.
DeviceReading press_deep(double time) {
    return ready_at(at_depth(28 + std::min(7.0, 100 * time)));
}

/// Ticks and limits from a recorder's queue.
struct Recorded {
    std::vector<SessionTick> ticks;
    std::vector<DeviceLimits> limits;
    std::size_t ticks_before_limits = 0;

    /// Renders the ticks again from `begin`, which has to give the same bits.
    Recorded(Queue<SessionEvent>& queue, Session begin) {
        const RendererSettings start = begin.renderer.settings;
        const Field field = begin.renderer.field;
        while (const auto event = queue.pop()) {
            if (const auto* command = std::get_if<Command>(&*event)) {
                if (const auto* to = std::get_if<DeviceLimits>(command)) {
                    keep_within(begin, *to);
                    if (limits.empty()) ticks_before_limits = ticks.size();
                    limits.push_back(*to);
                } else {
                    apply(begin, CheckedCommand(*command, start, kind_of(field)));
                }
                continue;
            }
            ticks.push_back(std::get<SessionTick>(*event));
            const SessionTick again = repeat(begin, ticks.back());
            EXPECT_EQ(again.tick.force, ticks.back().tick.force) << "tick " << ticks.size() - 1;
            EXPECT_EQ(again.tick.force_flags, ticks.back().tick.force_flags);
        }
    }
    double largest_force(std::size_t from = 0) const {
        double largest = 0;
        for (std::size_t i = from; i < ticks.size(); ++i) {
            largest = std::max(largest, ticks[i].tick.force.norm());
        }
        return largest;
    }
};

TEST(ServoLimits, limits_that_lower_nothing_are_refused_and_leave_those_that_hold) {
    ScriptedDevice device(&press_deep, {.maximum_force = 1});
    Servo servo(session_of(careless()), device, stepped({}));
    DeviceLimits limits = servo.settings().device;
    EXPECT_TRUE(servo.send(limits));
    limits.maximum_force = 2;
    EXPECT_THROW(servo.send(limits), std::invalid_argument);
    limits.maximum_force = 0.2;
    EXPECT_TRUE(servo.send(limits));
    limits.maximum_force = 0.5;
    EXPECT_THROW(servo.send(limits), std::invalid_argument);
    run(servo, 300);
    EXPECT_GT(device.force().norm(), 0.19);
    EXPECT_LE(device.force().norm(), 0.2 * limit_rounding);
    servo.stop();
}

TEST(ServoLimits, a_device_for_1_newton_gets_no_more_whatever_is_asked) {
    ScriptedDevice device(&press_deep, {.maximum_force = 1});
    Queue<SessionEvent> queue(1 << 14);
    Servo servo(session_of(careless()), device, stepped({.recorder = &queue}));
    EXPECT_EQ(servo.settings().device.maximum_force, 1);
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force().norm() > 0.99; }));
    ForceSettings more = careless().force;
    more.limit = 1000;
    EXPECT_TRUE(servo.send(more));
    EXPECT_THROW(servo.send(DeviceLimits{.maximum_force = 20}), std::invalid_argument);
    EXPECT_TRUE(servo.send(servo.settings().device));
    run(servo, 200);
    servo.stop();
    EXPECT_LE(device.largest_force(), limit_rounding);
    // The recording has the limits, so that it replays from the session as the application gave it.
    const Recorded recorded(queue, session_of(careless()));
    EXPECT_EQ(recorded.ticks_before_limits, 0U);
    EXPECT_EQ(recorded.limits.size(), 2U);
    EXPECT_GT(recorded.largest_force(), 0.99);
}

TEST(ServoLimits, a_session_that_the_device_can_take_is_left_as_it_is) {
    ScriptedDevice device(&press_deep, {.maximum_force = 20});
    Queue<SessionEvent> queue(1 << 14);
    const Servo servo(session_of(careless()), device, {.recorder = &queue});
    EXPECT_EQ(servo.settings().force, careless().force);
    EXPECT_EQ(servo.settings().device, careless().device);
    EXPECT_FALSE(queue.pop());
}

TEST(ServoLimits, a_stiffness_that_the_device_cannot_render_is_lowered_and_as_a_command_refused) {
    ScriptedDevice device(&press_deep, {.maximum_force = 20, .rate = 250});
    Servo servo(session_of(careless()), device, stepped());
    const RendererSettings& settings = servo.settings();
    EXPECT_EQ(settings.device.rate, 250);
    EXPECT_NEAR(settings.force.stiffness, 1.25, 1e-6);
    EXPECT_NO_THROW(check(settings.force, device.info().limits));
    EXPECT_THROW(servo.send(careless().force), std::invalid_argument);
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force().norm() > 6; }));  // 5 mm of it
    servo.stop();
    EXPECT_LT(device.largest_force(), 6.26);
}

TEST(ServoLimits, a_device_that_declares_nonsense_is_refused) {
    constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
    for (const DeviceLimits& limits :
         {DeviceLimits{.maximum_force = not_a_number}, DeviceLimits{.maximum_force = -1},
          DeviceLimits{.rate = 0}, DeviceLimits{.physical_damping = not_a_number}}) {
        ScriptedDevice device(&press_deep, limits);
        EXPECT_THROW(Servo(session_of(careless()), device), std::invalid_argument);
    }
}

TEST(ServoLimits, limits_that_a_device_learns_when_it_connects_hold_from_that_tick_on) {
    const DeviceLimits learned{.maximum_force = 1, .rate = 250};
    ScriptedDevice device(
        [&](double time) {
            DeviceReading reading = press_deep(time);
            if (time > 0.1) reading.limits = learned;
            return reading;
        },
        {.maximum_force = 20});
    Queue<SessionEvent> queue(1 << 14);
    Servo servo(session_of(careless()), device, stepped({.recorder = &queue}));
    run(servo, 101);
    EXPECT_GT(servo.snapshot()->stiffness, 2);
    tick(servo);  // the first after 0.1 s
    EXPECT_LT(servo.snapshot()->stiffness, 2);
    // The command passes the check, which knows the first limits only, and is lowered when applied.
    EXPECT_TRUE(servo.send(careless().force));
    run(servo, 100);
    servo.stop();
    EXPECT_NEAR(servo.session().renderer.settings.force.stiffness, 1.25, 1e-6);
    const Recorded recorded(queue, session_of(careless()));
    ASSERT_EQ(recorded.limits.size(), 1U);  // once, not with every reading
    EXPECT_EQ(recorded.limits[0], learned);
    EXPECT_EQ(recorded.ticks_before_limits, 101U);
    EXPECT_LE(recorded.largest_force(recorded.ticks_before_limits), limit_rounding);
}

TEST(ServoLimits, limits_in_a_reading_that_are_no_numbers_mean_no_force) {
    ScriptedDevice device([](double time) {
        DeviceReading reading = press_deep(time);
        if (time > 0.1) reading.limits = DeviceLimits{std::nan(""), std::nan(""), std::nan("")};
        return reading;
    });
    Queue<SessionEvent> queue(1 << 14);
    Servo servo(session_of({}), device, stepped({.recorder = &queue}));
    run(servo, 300);
    servo.stop();
    const Recorded recorded(queue, session_of({}));
    ASSERT_EQ(recorded.limits.size(), 1U);
    EXPECT_EQ(recorded.largest_force(recorded.ticks_before_limits), 0);
}

}  // namespace
