// A servo that its owner steps: the ticks of its session, with neither thread nor clock.
#include <gtest/gtest.h>

#include <stdexcept>

#include "palpate/servo.hpp"
#include "support/press.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

Session pressing() {
    return {make_renderer(ramp_field(), 30), {}};
}

/// Time of a step, for the servo [ns] and for the session [s].
std::int64_t ns_of(int step) {
    return std::int64_t{1'000'000} * step;
}
double step_time(int step) {
    return 1e-9 * static_cast<double>(ns_of(step));
}

/// A hand that goes into the ramp, 0.05 mm per tick.
DeviceReading entering_hand(double time) {
    return ready_at(at_depth(20 + 50 * time));
}

}  // namespace

TEST(SteppedServo, renders_the_ticks_of_its_session_and_records_them_with_the_commands) {
    ScriptedDevice device(entering_hand);
    Queue<SessionEvent> recorder(2000);
    Servo servo(pressing(), device, {.recorder = &recorder});
    Session expected = pressing();
    for (int i = 0; i < 500; ++i) {
        if (i == 300) {
            ASSERT_TRUE(servo.send(command::Isovalue{28}));
            EXPECT_EQ(servo.waiting(), 1);
            apply(expected, command::Isovalue{28});
        }
        servo.step(ns_of(i));
        if (i == 300) {
            EXPECT_TRUE(std::holds_alternative<Command>(recorder.pop().value()));
        }
        const SessionTick tick = advance(expected, step_time(i), entering_hand(step_time(i)));
        const Snapshot now = servo.snapshot().value();
        const auto recorded = std::get<SessionTick>(recorder.pop().value());
        ASSERT_EQ(now.number, i);
        ASSERT_EQ(now.session.tick.force, tick.tick.force) << i;
        ASSERT_EQ(now.session.tick.proxy.scp, tick.tick.proxy.scp) << i;
        ASSERT_EQ(recorded.tick.force, tick.tick.force) << i;
        ASSERT_EQ(device.force(), tick.tick.force) << i;
    }
    EXPECT_GT(device.largest_force(), 1);
    EXPECT_EQ(servo.report().ticks, 500);
    EXPECT_EQ(servo.report().compute.count, 0U) << "nothing is timed";
    EXPECT_EQ(servo.report().missed, 0);
    EXPECT_EQ(servo.waiting(), 0);
}

TEST(SteppedServo, writes_zero_when_it_is_stopped_and_renders_nothing_more) {
    ScriptedDevice device(entering_hand);
    Servo servo(pressing(), device);
    for (int i = 0; i < 500; ++i) servo.step(ns_of(i));
    ASSERT_GT(device.force().norm(), 1);
    servo.stop();
    EXPECT_EQ(device.force().norm(), 0);
    const std::int64_t writes = device.writes();
    EXPECT_FALSE(servo.step(ns_of(600)));
    servo.stop();
    EXPECT_EQ(device.writes(), writes);
    EXPECT_EQ(servo.report().ticks, 500);
}

TEST(SteppedServo, a_device_may_stop_it_and_one_that_throws_ends_it) {
    Servo* own = nullptr;
    ScriptedDevice stopping([&own](double time) {
        if (time > 0.4005) own->stop();
        return entering_hand(time);
    });
    Servo servo(pressing(), stopping);
    own = &servo;
    for (int i = 0; i < 500; ++i) servo.step(ns_of(i));
    EXPECT_EQ(servo.report().ticks, 402);
    EXPECT_GT(stopping.largest_force(), 1);
    EXPECT_EQ(stopping.force().norm(), 0);

    class Broken : public Device {
      public:
        DeviceInfo info() const override { return {}; }
        DeviceReading read(double time) override {
            if (time > 0.4005) throw std::runtime_error("cable pulled");
            return entering_hand(time);
        }
        void write(const Wrench&, double) override {}
        void stop() noexcept override { stopped = true; }
        bool stopped = false;
    };
    Broken broken;
    Servo failing(pressing(), broken);
    for (int i = 0; i < 500; ++i) failing.step(ns_of(i));
    EXPECT_EQ(failing.device_failure(), DeviceFailure::threw);
    EXPECT_TRUE(broken.stopped);
    EXPECT_EQ(failing.report().ticks, 401);
    EXPECT_EQ(failing.snapshot()->session.device.status, DeviceStatus::fault);
    EXPECT_EQ(failing.snapshot()->session.tick.force.norm(), 0);
}

TEST(SteppedServo, that_was_stepped_is_not_started) {
    ScriptedDevice device(entering_hand);
    Servo stepped(pressing(), device);
    stepped.step(0);
    EXPECT_THROW(stepped.start(), std::logic_error);
}

TEST(SteppedServo, its_session_has_all_commands_also_those_that_no_tick_has_executed) {
    ScriptedDevice device(entering_hand);
    Servo servo(pressing(), device);
    servo.step(0);
    EXPECT_EQ(servo.sure_tick(), 2);
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(servo.send(command::Isovalue{20.0 + i}));
    const std::int64_t sure = servo.sure_tick();
    int tick = 0;
    while (servo.waiting() > 0) servo.step(ns_of(++tick));
    EXPECT_GT(tick, 2);
    EXPECT_LE(tick, sure);
    EXPECT_THROW((void)servo.session(), std::logic_error);
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(servo.send(command::Isovalue{30.0 + i}));
    servo.step(ns_of(++tick));
    servo.stop();
    ASSERT_TRUE(servo.send(command::Freeze{true})) << "after its end";
    EXPECT_GT(servo.waiting(), 0);
    EXPECT_EQ(servo.session().renderer.proxy.isovalue, 89);
    EXPECT_TRUE(servo.session().frozen);
    EXPECT_EQ(servo.waiting(), 0);
}
