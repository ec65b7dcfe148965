// Servo: samples that are sent while it runs are felt at once, one version per tick, and are freed
// by other threads.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <thread>

#include "palpate/edit.hpp"
#include "palpate/servo.hpp"
#include "support/edits.hpp"
#include "support/scripted_device.hpp"
#include "support/stepped_servo.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// Density = z + shift: the level 30 lies at 30 - shift, everywhere.
Volume wide_ramp(double shift) {
    return volume_of<float>(grid({40, 40, 60}), [&](const Index3& i) { return i[2] + shift; });
}
std::shared_ptr<const Samples> plain_ramp() {
    return samples_of(wide_ramp(0));
}
/// The same by edits: all of the samples in bricks.
std::shared_ptr<const Samples> edited_ramp(const std::shared_ptr<const Samples>& from,
                                           double shift) {
    return edited(from, edit::Replace{Index3::Zero(), wide_ramp(shift)}).samples;
}

/// Slides about inside the solid, whatever the shift.
DeviceReading slide(double time) {
    return ready_at({20 + 9 * std::sin(11 * time), 20 + 9 * std::sin(7 * time), 36});
}

Session session_on(const std::shared_ptr<const Samples>& samples) {
    return {make_renderer(linear_field(samples, Solid::above, 0.0), 30), {}};
}

TEST(ChangingServo, an_edit_that_was_sent_is_felt_in_the_next_tick) {
    ScriptedDevice device(&slide);
    Queue<SessionEvent> recorder(1 << 16);
    const auto begin = plain_ramp();
    Servo servo(session_on(begin), device, stepped({.recorder = &recorder}));
    run(servo, 3);
    std::map<std::uint64_t, std::int64_t> first;  // tick in which a version must be felt
    std::map<std::uint64_t, double> shifts;
    for (std::uint64_t version = 1; version <= (is_slow_build ? 12 : 60); ++version) {
        const double shift = 0.25 * double(version % 9);
        const auto samples = edited_ramp(begin, shift);
        ASSERT_TRUE(servo.send(command::Samples{samples, version}));
        first[version] = servo.report().ticks;  // the next one
        shifts[version] = shift;
        run(servo, 5);
    }
    servo.stop();
    EXPECT_EQ(servo.report().unrecorded, 0);
    std::int64_t number = 0;
    std::uint64_t last = 0;
    std::size_t seen = 0;
    while (const auto event = recorder.pop()) {
        const auto* tick = std::get_if<SessionTick>(&*event);
        if (!tick) continue;
        if (tick->version != last) {
            last = tick->version;
            ++seen;
            EXPECT_EQ(number, first[last]) << "version " << last;
            EXPECT_NEAR(tick->tick.proxy.scp[2], 30 - shifts[last], 1e-6);  // felt, not only seen
        }
        ++number;
    }
    EXPECT_EQ(seen, first.size());
}

TEST(ChangingServo, a_tick_sees_one_version_and_lies_on_its_surface) {
    ScriptedDevice device(&slide);
    Queue<SessionEvent> recorder(1 << 17);
    const auto begin = plain_ramp();
    Servo servo(session_on(begin), device, stepped({.rate = 4000, .recorder = &recorder}));
    std::vector<std::shared_ptr<const Samples>> versions{begin};
    for (int i = 1; i < 8; ++i) versions.push_back(edited_ramp(begin, i * 0.5));
    std::atomic<bool> done{false};
    std::atomic<std::int64_t> seen{0}, wrong{0};
    const auto off = [](const SessionTick& tick) {
        const double shift = 0.5 * double(tick.version);
        const ProxyUpdate& p = tick.tick.proxy;
        return std::max(std::abs(p.density - (p.scp[2] + shift)), std::abs(p.density - 30)) / 59;
    };
    std::jthread observer([&] {
        while (!done) {
            const auto snapshot = servo.snapshot();
            if (!snapshot || snapshot->session.tick.proxy.mode == Mode::free) continue;
            ++seen;
            wrong += !(off(snapshot->session) <= 1e-9);
        }
    });
    Random random(1);
    for (int i = 0; i < scaled(1500); ++i) {
        const std::size_t v = random.bits() % versions.size();
        servo.send(command::Samples{versions[v], v});
        tick(servo);
    }
    // Until there was something to see.
    EXPECT_TRUE(ticks_until(
        servo, [&] { return seen > 0; }, 100'000'000));
    done = true;
    observer.join();
    servo.stop();
    EXPECT_EQ(wrong, 0);
    std::int64_t changes = 0, ticks = 0;
    std::uint64_t last = 0;
    while (const auto event = recorder.pop()) {
        const auto* tick = std::get_if<SessionTick>(&*event);
        if (!tick) continue;
        ASSERT_EQ(tick->tick.proxy.mode, Mode::constrained);
        ASSERT_LE(off(*tick), 1e-9) << "tick " << ticks << " of version " << tick->version;
        changes += tick->version != last;
        last = tick->version;
        ++ticks;
    }
    EXPECT_GT(changes, scaled(100));
}

TEST(ChangingServo, versions_are_freed_once_it_has_gone_on) {
    ScriptedDevice device(&slide);
    Servo servo(session_on(plain_ramp()), device, stepped());
    const auto base = plain_ramp();
    std::vector<std::weak_ptr<const Samples>> sent;
    std::vector<std::weak_ptr<const Recipe>> recipes;
    for (std::uint64_t version = 1; version <= 12; ++version) {
        const auto samples = edited_ramp(base, 1 + double(version % 5));
        const auto recipe = std::make_shared<const Recipe>(EditOf{version - 1, edit::Fill{}});
        sent.push_back(samples);
        recipes.push_back(recipe);
        ASSERT_TRUE(servo.send(command::Samples{samples, version, recipe}));
        tick(servo);
        ASSERT_EQ(servo.snapshot()->session.version, version);
    }
    // In use: the last. Held until the next is sent: the one before.
    for (std::size_t i = 0; i + 2 < sent.size(); ++i) {
        EXPECT_TRUE(sent[i].expired()) << i;
        EXPECT_TRUE(recipes[i].expired()) << i;
    }
    EXPECT_FALSE(sent.back().expired());
}

TEST(ChangingServo, versions_that_were_sent_many_times_are_freed_too) {
    ScriptedDevice device(&slide);
    Servo servo(session_on(plain_ramp()), device, stepped({.rate = 4000}));
    std::weak_ptr<const Samples> gone[2];
    {
        const auto base = plain_ramp();
        const std::shared_ptr<const Samples> versions[] = {edited_ramp(base, 1),
                                                           edited_ramp(base, 2)};
        gone[0] = versions[0];
        gone[1] = versions[1];
        const auto recipe = std::make_shared<const Recipe>(EditOf{});
        for (std::uint64_t i = 0; i < 20; ++i) {
            ASSERT_TRUE(servo.send(command::Samples{versions[i % 2], 1 + i % 2, recipe}));
            if (i % 3 == 0) tick(servo);
        }
    }
    for (std::uint64_t version = 3; version <= 5; ++version) {
        ASSERT_TRUE(servo.send(command::Samples{plain_ramp(), version}));
        tick(servo);
        ASSERT_EQ(servo.snapshot()->session.version, version);
    }
    EXPECT_TRUE(gone[0].expired());
    EXPECT_TRUE(gone[1].expired());
}

TEST(ChangingServo, samples_on_another_grid_are_refused) {
    ScriptedDevice device(&slide);
    Servo servo(session_on(plain_ramp()), device);
    EXPECT_THROW(servo.send(command::Samples{}), std::invalid_argument);
    EXPECT_THROW(
        servo.send(command::Samples{samples_of(noise_of(SampleType::float32, grid(cube(3)), 1))}),
        std::invalid_argument);
}

TEST(ChangingServo, what_was_recorded_of_changing_samples_gives_the_same_ticks_again) {
    ScriptedDevice device(&slide);
    Queue<SessionEvent> recorder(1 << 17);
    const Session begin = session_on(plain_ramp());
    Servo servo(begin, device, stepped({.rate = 4000, .recorder = &recorder}));
    Editor editor(begin.renderer.field.shared_samples());
    const auto sequence = std::make_shared<const Samples>(
        std::vector<Frame>{{0, wide_ramp(0)}, {0.05, wide_ramp(3)}}, 0.1);
    for (std::uint64_t i = 1; i <= 150; ++i) {
        const auto now = servo.snapshot();
        const Vec3 at = now ? now->session.tick.proxy.scp : Vec3(20, 20, 30);
        const Brush brush =
            brush_for(i % 3 ? BrushKind::carve : BrushKind::add, begin.renderer.field, 30, 2.5);
        editor.apply(edit::Stroke{brush, at, at});
        if (i % 10 == 0) editor.undo();
        servo.send(command::Samples{i % 7 == 0 ? sequence : editor.samples(), i});
        if (i % 7 == 0) servo.send(command::Speed{i % 2 ? 1.0 : -0.7});
        run(servo, 12);
    }
    servo.stop();
    ASSERT_EQ(servo.report().unrecorded, 0);
    Session session = begin;
    std::int64_t ticks = 0, versions = 0, played = 0;
    while (const auto event = recorder.pop()) {
        if (const auto* command = std::get_if<Command>(&*event)) {
            apply(session, *command);
            versions += std::holds_alternative<command::Samples>(*command);
            continue;
        }
        const auto& recorded = std::get<SessionTick>(*event);
        const SessionTick again = repeat(session, recorded);
        ASSERT_EQ(again.tick.proxy.scp, recorded.tick.proxy.scp) << "tick " << ticks;
        ASSERT_EQ(again.tick.force, recorded.tick.force) << "tick " << ticks;
        ASSERT_EQ(again.moment, recorded.moment);
        ASSERT_EQ(again.version, recorded.version);
        played += recorded.moment > 0;
        ++ticks;
    }
    EXPECT_EQ(versions, 150);
    EXPECT_GT(played, 0);
}

}  // namespace
