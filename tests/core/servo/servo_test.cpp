// Servo: its ticks in virtual time, commands, snapshots, recordings, and zero force after failures;
// one test of its thread at its real pace.
#include "palpate/servo.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "support/eventually.hpp"
#include "support/press.hpp"
#include "support/scripted_device.hpp"
#include "support/stepped_servo.hpp"

using namespace palpate;
using namespace palpate::support;
using namespace std::chrono_literals;

namespace {

Session ramp_session(const RendererSettings& settings = {}) {
    return {make_renderer(ramp_field(), 30, settings), {}};
}

/// Presses 1 mm into the ramp's level 30 and rests there.
DeviceReading press(double time) {
    return ready_at(at_depth(29 + std::min(2.0, 20 * time)));
}

/// A session whose next tick takes 60 ms once `stall` is set, in its penetrability function.
Session stalling_session(std::atomic<bool>& stall) {
    RendererSettings settings;
    settings.penetrability = penetrability_threshold(1, 0);
    settings.penetrability.function = [](const Pressing&, const void* to) {
        auto& now = *static_cast<std::atomic<bool>*>(const_cast<void*>(to));
        if (now.exchange(false)) pass(60ms);
        return 1.0;
    };
    settings.penetrability.context = &stall;
    return ramp_session(settings);
}

TEST(Servo, counts_ticks_that_come_when_they_are_due) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, stepped({.rate = 1000}));
    EXPECT_FALSE(servo.snapshot());
    run(servo, 1000);
    servo.stop();
    const ServoReport report = servo.report();
    EXPECT_EQ(report.ticks, 1000);
    EXPECT_EQ(report.missed, 0);
    EXPECT_EQ(report.period.count, 999U);
    EXPECT_EQ(report.compute.count, 1000U);
    EXPECT_EQ(report.period.max, 1'000'000);
    EXPECT_EQ(report.lateness.max, 0);
    EXPECT_EQ(report.work.max, 0);
    EXPECT_EQ(device.reads(), report.ticks);
    EXPECT_EQ(device.writes(), report.ticks + 1);  // and the zero at the end
    EXPECT_NEAR(servo.snapshot()->session.tick.time, 0.999, 1e-12);
}

TEST(Servo, a_thread_that_is_woken_late_has_missed_ticks_and_the_machine_is_to_blame) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, stepped());
    run(servo, 100);
    pass(5500us);
    run(servo, 100);
    const ServoReport report = servo.report();
    EXPECT_EQ(report.worst.tick, 100);
    EXPECT_EQ(report.worst.lateness_ns, 4'500'000);  // it was due a millisecond later
    EXPECT_EQ(report.worst.cause, TickCause::machine);
    EXPECT_EQ(report.lateness.max, 4'500'000);
    EXPECT_EQ(report.missed, 4);
    EXPECT_EQ(report.overruns, 0);
    EXPECT_NEAR(servo.snapshot()->session.tick.time, 0.202, 1e-12);  // the others are on time
}

TEST(Servo, is_started_once) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, stepped());
    EXPECT_TRUE(servo.step());
    EXPECT_THROW(servo.start(), std::logic_error);
    servo.stop();
    EXPECT_THROW(servo.start(), std::logic_error);
    EXPECT_FALSE(servo.step());
    EXPECT_EQ(servo.report().ticks, 1);
}

TEST(Servo, ticks_before_they_are_due_miss_nothing) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, stepped());
    for (int i = 0; i < 100; ++i) {
        servo.step();
        pass(std::chrono::microseconds(10));
    }
    EXPECT_EQ(servo.report().missed, 0);
}

TEST(Servo, a_session_that_has_stopped_goes_on_in_another_servo) {
    ScriptedDevice device(&press);
    Session left = ramp_session();
    {
        Servo servo(ramp_session(), device, stepped());
        tick(servo);
        EXPECT_THROW((void)servo.session(), std::logic_error);
        servo.send(command::Isovalue{25});
        tick(servo);
        EXPECT_EQ(servo.snapshot()->session.tick.proxy.isovalue, 25);
        servo.stop();
        left = servo.session();
        const SessionTick last = servo.snapshot()->session;
        EXPECT_EQ(left.renderer.proxy.scp_physical, last.tick.proxy.scp);
        EXPECT_EQ(left.renderer.proxy.isovalue, 25);
    }
    Servo servo({make_renderer(left.renderer.field, left.renderer.proxy.isovalue), left.settings},
                device, stepped());
    tick(servo);
    EXPECT_EQ(servo.snapshot()->session.tick.proxy.isovalue, 25);
}

TEST(Servo, a_snapshot_tells_where_the_proxy_is_in_its_tetrahedron) {
    Session session = ramp_session();
    for (int i = 1; i < 400; ++i) {
        const SessionTick tick = advance(session, 1e-3 * i, press(1e-3 * i));
        const Snapshot seen = snapshot_of(session, tick, i, 0);
        EXPECT_NEAR((physical_from_index(session.renderer.field.geometry(), index_of(seen.scp)) -
                     tick.tick.proxy.scp)
                        .norm(),
                    0, 1e-9);
        EXPECT_EQ(seen.number, i);
        EXPECT_EQ(seen.stiffness, session.renderer.settings.force.stiffness);
    }
}

TEST(Servo, forces_rise_from_zero_and_end_at_zero) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, stepped());
    tick(servo);
    EXPECT_EQ(device.force(), Vec3(0, 0, 0));
    ASSERT_TRUE(ticks_until(
        servo, [&] { return device.force().norm() > 0.49; }, 400));
    EXPECT_LT(device.force()[2], 0);  // outwards
    servo.stop();
    EXPECT_EQ(device.force(), Vec3(0, 0, 0));
}

TEST(Servo, destroying_it_ends_at_zero_too) {
    ScriptedDevice device(&press);
    {
        Servo servo(ramp_session(), device, stepped());
        ASSERT_TRUE(ticks_until(servo, [&] { return device.force().norm() > 0.1; }));
    }
    EXPECT_EQ(device.force(), Vec3(0, 0, 0));
}

TEST(Servo, a_device_that_fails_in_contact_gets_no_force) {
    DeviceStatus status = DeviceStatus::ready;
    ScriptedDevice device([&](double time) {
        DeviceReading reading = press(time);
        reading.status = status;
        return reading;
    });
    Servo servo(ramp_session(), device, stepped());
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force().norm() > 0.4; }));
    status = DeviceStatus::lost;
    tick(servo);
    EXPECT_EQ(device.force(), Vec3(0, 0, 0));
    EXPECT_EQ(servo.snapshot()->session.device.status, DeviceStatus::lost);
}

TEST(Servo, a_tick_that_takes_too_long_takes_its_force_back) {
    std::atomic<bool> stall{false};
    ScriptedDevice device(&press);
    Queue<SessionEvent> recorder(1 << 14);
    Servo servo(stalling_session(stall), device, stepped({.recorder = &recorder}));
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force().norm() > 0.4; }));
    stall = true;
    tick(servo);
    EXPECT_EQ(device.force(), Vec3(0, 0, 0));
    EXPECT_EQ(servo.report().overruns, 1);
    EXPECT_EQ(servo.report().missed, 60);
    EXPECT_EQ(servo.report().worst.work_ns, 60'000'000);
    std::optional<SessionEvent> last;
    while (auto event = recorder.pop()) last = std::move(event);
    const auto& recorded = std::get<SessionTick>(*last);
    EXPECT_TRUE(recorded.tick.force_flags & force_overrun);
    EXPECT_EQ(recorded.tick.force, Vec3(0, 0, 0));
}

TEST(Servo, ticks_that_were_due_during_a_stall_are_not_made_up) {
    std::atomic<bool> stall{false};
    ScriptedDevice device(&press);
    Servo servo(stalling_session(stall), device, stepped());
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force().norm() > 0.1; }));
    const double before = servo.snapshot()->session.tick.time;
    stall = true;
    run(servo, 3);  // the stall, and two that are on time
    EXPECT_NEAR(servo.snapshot()->session.tick.time - before, 0.062, 1e-12);
    EXPECT_EQ(servo.report().missed, 60);
}

TEST(Servo, a_flood_of_commands_is_spread_over_ticks) {
    ScriptedDevice device(&press);
    Queue<SessionEvent> recorder(1 << 14);
    Servo servo(ramp_session(), device, stepped({.command_room = 64, .recorder = &recorder}));
    for (int i = 0; i < 40; ++i) ASSERT_TRUE(servo.send(command::Isovalue{30.0 + i}));
    run(servo, 4);
    std::vector<int> commands(1);  // before each tick
    while (const auto event = recorder.pop()) {
        if (std::holds_alternative<SessionTick>(*event)) {
            commands.push_back(0);
        } else {
            ++commands.back();
        }
    }
    EXPECT_EQ(commands, (std::vector<int>{16, 16, 8, 0, 0}));
}

TEST(Servo, tells_the_device_from_the_proxy_and_the_machine) {
    ScriptedDevice device([&](double time) {
        pass(1ms);
        return press(time);
    });
    RendererSettings settings;
    settings.device.rate = 500;
    Servo servo(ramp_session(settings), device, stepped({.rate = 500}));
    run(servo, 200);
    EXPECT_EQ(servo.report().compute.max, 1'000'000);
    EXPECT_EQ(servo.report().worst.cause, TickCause::device);
    EXPECT_EQ(servo.report().missed, 0);
    std::set<std::string> names;
    for (int c = 0; c <= static_cast<int>(TickCause::other); ++c) {
        names.insert(name_of(static_cast<TickCause>(c)));
    }
    EXPECT_EQ(names.size(), 5U);
}

TEST(Servo, commands_take_effect_and_show_in_snapshots) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, stepped());
    EXPECT_TRUE(servo.send(command::Isovalue{30.5}));
    tick(servo);
    EXPECT_EQ(servo.snapshot()->session.tick.proxy.isovalue, 30.5);
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force().norm() > 0.1; }));
    ForceSettings force;
    force.stiffness = 1.25;
    EXPECT_TRUE(servo.send(force));
    EXPECT_TRUE(servo.send(command::Forces{false}));
    tick(servo);
    EXPECT_EQ(servo.snapshot()->stiffness, 1.25);
    EXPECT_FALSE(servo.snapshot()->forces_on);
    EXPECT_EQ(device.force(), Vec3(0, 0, 0));
    EXPECT_TRUE(servo.send(penetrability_threshold(1, 0)));
    tick(servo);
    EXPECT_TRUE(servo.snapshot()->penetrability_on);
    const Snapshot seen = *servo.snapshot();
    EXPECT_NEAR((seen.normal - Vec3(0, 0, -1)).norm(), 0, 1e-12);
}

TEST(Servo, refuses_commands_that_cannot_be_carried_out_and_says_when_it_has_no_room) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, {.command_room = 4});
    ForceSettings hard;
    hard.stiffness = 1000;
    EXPECT_THROW(servo.send(hard), std::invalid_argument);
    EXPECT_THROW(servo.send(command::Isovalue{std::numeric_limits<double>::quiet_NaN()}),
                 std::invalid_argument);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(servo.send(command::Isovalue{30}));
    EXPECT_FALSE(servo.send(command::Isovalue{30}));  // it does not run yet
}

TEST(Servo, a_session_that_has_ended_takes_commands_without_end_and_keeps_nothing_of_them) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, stepped({.command_room = 4}));
    EXPECT_FALSE(servo.has_ended());
    run(servo, 2);
    EXPECT_FALSE(servo.has_ended());
    servo.stop();
    EXPECT_TRUE(servo.has_ended());
    const auto samples = std::make_shared<const Samples>(ramp_field().samples());
    for (int i = 0; i < 9; ++i) EXPECT_TRUE(servo.send(command::Samples{samples, 1}));
    EXPECT_EQ(samples.use_count(), 1);
    EXPECT_EQ(servo.waiting(), 9);
    EXPECT_THROW(servo.send(command::Isovalue{std::nan("")}), std::invalid_argument);
}

TEST(Servo, settings_that_cannot_be_run_are_refused) {
    ScriptedDevice device(&press);
    EXPECT_THROW(Servo(ramp_session(), device, {.rate = 249}), std::invalid_argument);
    EXPECT_THROW(Servo(ramp_session(), device, {.rate = 8001}), std::invalid_argument);
    EXPECT_THROW(Servo(ramp_session(), device, {.priority = 0}), std::invalid_argument);
    EXPECT_THROW(Servo(ramp_session(), device, {.rate = 500}), std::invalid_argument);
    const auto refuses = [&](auto&& change) {
        Session session = ramp_session();
        change(session.renderer);
        EXPECT_THROW(Servo(session, device), std::invalid_argument);
    };
    refuses([](Renderer& r) { r.settings.force.stiffness = -1; });
    // Checks that depend on the field, too.
    refuses([](Renderer& r) { r.proxy.isovalue = -HUGE_VAL; });
    refuses([](Renderer& r) {
        const std::array<DensityRange, 2> falling{DensityRange{0, 10}, {20, 30}};
        r.settings.penetrability = penetrability_ranges(1, falling, Solid::below);
    });
    refuses([](Renderer& r) {
        Layers falling;
        falling.layers = {{.name = "bone", .level = 40}, {.name = "skin", .level = 30}};
        r.settings.layers = std::make_shared<const Layers>(falling);
    });
    refuses([](Renderer& r) {
        r.field.set_interpolation(Interpolation::linear);
        r.settings.tool = std::make_shared<const Tool>();
    });
    Session session = ramp_session();
    session.speed = std::nan("");
    EXPECT_THROW(Servo(session, device), std::invalid_argument);
}

TEST(Servo, what_was_recorded_gives_the_same_ticks_again_bit_for_bit) {
    ScriptedDevice device([](double time) {
        return ready_at(at_depth(31 + 2 * std::sin(40 * time)) + Vec3(std::sin(9 * time), 0, 0));
    });
    const Session begin = ramp_session();
    Queue<SessionEvent> recorder(1 << 14);
    Servo servo(begin, device, stepped({.rate = 4000, .recorder = &recorder}));
    const Penetrability threshold = penetrability_threshold(0.8, 20);
    for (int round = 0; servo.report().ticks < 4000; ++round) {
        servo.send(command::Isovalue{28.0 + round % 5});
        servo.send(command::Scale{1 + 0.1 * (round % 3)});
        if (round % 7 == 3) servo.send(threshold);
        if (round % 7 == 6) servo.send(no_penetrability());
        if (round % 11 == 5) servo.send(command::Freeze{round % 2 == 0});
        run(servo, 20);
    }
    servo.stop();
    EXPECT_EQ(servo.report().unrecorded, 0);

    Session session = begin;
    std::int64_t ticks = 0, commands = 0, felt = 0;
    while (const auto event = recorder.pop()) {
        if (const auto* command = std::get_if<Command>(&*event)) {
            apply(session, *command);
            ++commands;
            continue;
        }
        const auto& recorded = std::get<SessionTick>(*event);
        const SessionTick again = repeat(session, recorded);
        ASSERT_EQ(again.tick.force, recorded.tick.force) << "tick " << ticks;
        ASSERT_EQ(again.tick.proxy.scp, recorded.tick.proxy.scp) << "tick " << ticks;
        ASSERT_EQ(again.tick.proxy.isovalue, recorded.tick.proxy.isovalue);
        ASSERT_EQ(again.tick.force_flags, recorded.tick.force_flags);
        felt += !again.tick.force.isZero(0);
        ++ticks;
    }
    EXPECT_EQ(ticks, servo.report().ticks);
    EXPECT_GT(commands, 10);
    EXPECT_GT(felt, 50);
}

TEST(Servo, a_recorder_that_is_full_is_counted_and_holds_nothing_up) {
    ScriptedDevice device(&press);
    Queue<SessionEvent> recorder(8);
    Servo servo(ramp_session(), device, stepped({.recorder = &recorder}));
    run(servo, 200);
    EXPECT_EQ(servo.report().unrecorded, 200 - static_cast<std::int64_t>(recorder.capacity()));
}

TEST(Servo, any_number_of_observers_see_ticks_that_only_go_forward) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, stepped({.rate = 4000}));
    std::atomic<bool> done{false};
    std::atomic<std::int64_t> back{0}, seen{0};
    std::vector<std::jthread> observers;
    for (int i = 0; i < 3; ++i) {
        observers.emplace_back([&] {
            std::int64_t last = -1;
            while (!done) {
                const auto snapshot = servo.snapshot();
                if (!snapshot) continue;
                ++seen;
                back += snapshot->number < last;
                // Position and time belong together.
                back += snapshot->session.device.position !=
                        press(snapshot->session.tick.time).position;
                last = snapshot->number;
            }
        });
    }
    EXPECT_TRUE(ticks_until(
        servo, [&] { return servo.report().ticks >= 500 && seen >= 500; }, 100'000'000));
    done = true;
    observers.clear();
    EXPECT_EQ(back, 0);
}

TEST(PacedServo, its_thread_renders_at_its_rate_until_it_is_stopped) {
    ScriptedDevice device(&press);
    Servo servo(ramp_session(), device, {.rate = 1000});
    const auto begun = std::chrono::steady_clock::now();
    servo.start();
    EXPECT_THROW(servo.start(), std::logic_error);
    EXPECT_EQ(servo.privileges().size(), 2U);
    EXPECT_THROW((void)servo.session(), std::logic_error);
    ASSERT_TRUE(comes_true([&] { return servo.report().ticks >= 500; }));
    EXPECT_TRUE(comes_true([&] { return device.force() != Vec3(0, 0, 0); }));
    servo.stop();
    EXPECT_EQ(device.force(), Vec3(0, 0, 0));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    const ServoReport report = servo.report();
    EXPECT_LE(static_cast<double>(report.ticks), 1000 * took.count() + 2) << "a busy one is slower";
    EXPECT_EQ(report.period.count, static_cast<std::uint64_t>(report.ticks - 1));
    EXPECT_LE(report.compute.p50, report.work.max);
    EXPECT_GE(report.worst.tick, 0);
    EXPECT_NE(report.worst.cause, TickCause::none);
    EXPECT_EQ(device.reads(), report.ticks);
    EXPECT_EQ(device.writes(), report.ticks + 1);
    EXPECT_TRUE(servo.session().past.begun);
}

}  // namespace
