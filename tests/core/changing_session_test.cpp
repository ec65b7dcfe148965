// Session: exchanged samples, and sequences that play by the times of the ticks.
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/session.hpp"
#include "support/allocation_counter.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// Density = z + shift [voxel, mm]: the level 30 lies at z = 30 - shift.
Volume shifted_ramp(double shift) {
    return volume_of<float>(grid({9, 9, 101}), [&](const Index3& i) { return i[2] + shift; });
}

/// At 0, 1 and 2 s the level lies at 30, 28 and 32.
std::shared_ptr<const Samples> swinging(double period = 0) {
    return std::make_shared<const Samples>(
        std::vector<Frame>{{0, shifted_ramp(0)}, {1, shifted_ramp(2)}, {2, shifted_ramp(-2)}},
        period);
}

struct ChangingSession {
    Session session;
    double time = 0;
    DeviceReading reading = ready_at({4.2, 3.9, 40});

    explicit ChangingSession(std::shared_ptr<const Samples> samples)
        : session{make_renderer(linear_field(std::move(samples)), 30), {}} {}
    SessionTick next(double dt = 1e-3) { return advance(session, time += dt, reading); }
    double moment() const { return session.renderer.field.time(); }
};

TEST(ChangingSession, plays_a_sequence_by_the_times_of_the_ticks) {
    ChangingSession live(swinging());
    Random random(1);
    live.next();
    EXPECT_EQ(live.next().moment, 0);  // stands still until it is played
    apply(live.session, command::Speed{0.5});
    double expected = 0;
    while (expected < 1.9) {
        const double dt = random.uniform(1e-4, 0.015);
        const SessionTick tick = live.next(dt);
        expected += 0.5 * dt;
        ASSERT_NEAR(tick.moment, expected, 1e-12);
        // The field of this moment is touched.
        const double shift = expected < 1 ? 2 * expected : 2 - 4 * (expected - 1);
        ASSERT_NEAR(tick.tick.proxy.scp[2], 30 - shift, 1e-4);
    }
}

TEST(ChangingSession, a_sequence_stops_at_its_ends_and_goes_on_backwards) {
    ChangingSession live(swinging());
    live.next();
    apply(live.session, command::Speed{100});
    for (int i = 0; i < 50; ++i) live.next();
    EXPECT_EQ(live.moment(), 2);
    apply(live.session, command::Speed{-1});
    live.next();
    EXPECT_NEAR(live.moment(), 1.999, 1e-12);
    apply(live.session, command::Speed{-1000});
    for (int i = 0; i < 5; ++i) live.next();
    EXPECT_EQ(live.moment(), 0);
}

TEST(ChangingSession, a_sequence_with_a_period_goes_round_both_ways) {
    for (const double speed : {1.0, -1.0}) {
        ChangingSession live(swinging(3));
        live.next();
        apply(live.session, command::Speed{speed});
        double highest = -1e9, lowest = 1e9;
        for (int i = 1; i <= 7000; ++i) {
            const SessionTick tick = live.next();
            const double t = std::fmod(speed * 1e-3 * i + 300, 3);
            const double shift = t < 1 ? 2 * t : t < 2 ? 2 - 4 * (t - 1) : -2 + 2 * (t - 2);
            ASSERT_NEAR(tick.tick.proxy.scp[2], 30 - shift, 1e-4);
            highest = std::max(highest, tick.tick.proxy.scp[2]);
            lowest = std::min(lowest, tick.tick.proxy.scp[2]);
        }
        EXPECT_NEAR(highest, 32, 1e-2);
        EXPECT_NEAR(lowest, 28, 1e-2);
        EXPECT_NEAR(live.moment(), 7 * speed, 1e-9);
    }
}

TEST(ChangingSession, goes_to_a_moment_and_stays_or_plays_on) {
    ChangingSession live(swinging());
    live.next();
    apply(live.session, command::Moment{1.5});
    EXPECT_EQ(live.next().moment, 1.5);
    EXPECT_EQ(live.next().moment, 1.5);
    apply(live.session, command::Moment{7});  // beyond the frames: the last
    EXPECT_EQ(live.next().moment, 2);
    apply(live.session, command::Speed{1});
    apply(live.session, command::Moment{0.25});
    EXPECT_NEAR(live.next().moment, 0.251, 1e-12);
}

TEST(ChangingSession, other_samples_take_effect_in_the_next_tick_and_keep_the_time) {
    ChangingSession live(swinging());
    live.next();
    apply(live.session, command::Moment{1.5});
    live.next();
    apply(live.session, command::Samples{swinging(), 7});
    SessionTick tick = live.next();
    EXPECT_EQ(tick.version, 7U);
    EXPECT_EQ(tick.moment, 1.5);
    apply(live.session, command::Samples{samples_of(shifted_ramp(5)), 8});
    tick = live.next();
    EXPECT_EQ(tick.version, 8U);
    EXPECT_EQ(tick.moment, 0);
    EXPECT_NEAR(tick.tick.proxy.scp[2], 25, 1e-4);
}

TEST(ChangingSession, ticks_whose_time_is_broken_play_nothing) {
    for (const double period : {0.0, 2.5}) {
        ChangingSession live(swinging(period));
        live.next();
        apply(live.session, command::Speed{1});
        live.next();
        const double before = live.moment();
        for (const double time : {not_a_number, infinity, -infinity, 0.0}) {
            advance(live.session, time, live.reading);
            EXPECT_EQ(live.moment(), before);
        }
        live.next();
        EXPECT_GT(live.moment(), before);
        EXPECT_LT(live.moment(), before + 0.01);
    }
}

TEST(ChangingSession, samples_and_moments_that_are_none_are_refused) {
    const RendererSettings settings;
    const Geometry geometry = shifted_ramp(0).geometry();
    const auto refused = [&](const Command& command) {
        EXPECT_THROW(check(command, settings, {geometry}), std::invalid_argument);
    };
    refused(command::Samples{});
    refused(command::Moment{std::nan("")});
    refused(command::Moment{infinity});
    refused(command::Speed{1001});
    refused(command::Speed{std::nan("")});
    refused(command::Samples{samples_of(noise_of(SampleType::uint8, grid(cube(3)), 1))});
    EXPECT_NO_THROW(check(command::Samples{swinging()}, settings, {geometry}));
}

/// Everything that makes samples change, at random.
struct ChangingHand {
    Random random{5};
    std::vector<std::shared_ptr<const Samples>> versions;

    ChangingHand() {
        auto edits = samples_of(shifted_ramp(0));
        for (int i = 0; i < 20; ++i) {
            versions.push_back(edits);
            const Vec3 at(4, 4, random.uniform(25, 35));
            const Brush brush = brush_for(i % 2 ? BrushKind::add : BrushKind::carve,
                                          linear_field(edits), 30, random.uniform(1, 3));
            edits = edited(edits, edit::Stroke{brush, at, at}).samples;
        }
        versions.push_back(swinging());
        versions.push_back(swinging(2.5));
    }
    void step(ChangingSession& live) {
        live.reading.position = {random.uniform(3, 5), random.uniform(3, 5),
                                 31 + 3 * std::sin(30 * live.time)};
        if (random.chance(0.1)) {
            const std::size_t i = random.bits() % versions.size();
            apply(live.session, command::Samples{versions[i], i});
        }
        if (random.chance(0.02)) apply(live.session, command::Moment{random.uniform(-1, 4)});
        if (random.chance(0.02)) apply(live.session, command::Speed{random.uniform(-5, 5)});
    }
};

TEST(ChangingSession, copies_go_on_alike_bit_for_bit) {
    ChangingHand hand;
    ChangingSession one(hand.versions.front());
    for (int i = 0; i < 1000; ++i) {
        hand.step(one);
        one.next();
    }
    ChangingHand other = hand;
    ChangingSession two = one;
    int felt = 0, played = 0;
    for (int i = 0; i < scaled(20'000); ++i) {
        hand.step(one);
        other.step(two);
        const SessionTick a = one.next(), b = two.next();
        ASSERT_EQ(a.tick.force, b.tick.force);
        ASSERT_EQ(a.tick.proxy.scp, b.tick.proxy.scp);
        ASSERT_EQ(a.moment, b.moment);
        ASSERT_EQ(a.version, b.version);
        felt += !a.tick.force.isZero(0);
        played += a.moment > 0;
    }
    EXPECT_GT(felt, scaled(2000));
    EXPECT_GT(played, scaled(100));
}

TEST(ChangingSession, neither_ticks_nor_new_samples_allocate_or_free) {
    ChangingHand hand;
    ChangingSession live(hand.versions.front());
    const std::int64_t allocations = allocation_count(), frees = thread_free_count();
    for (int i = 0; i < scaled(20'000); ++i) {
        hand.step(live);
        live.next();
    }
    EXPECT_EQ(allocation_count(), allocations);
    EXPECT_EQ(thread_free_count(), frees);
}

}  // namespace
