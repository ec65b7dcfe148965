// The uneven servo of a simulated device: its times, and their effect on poses and forces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "devices/link.hpp"
#include "devices/simulated/closed_loop.hpp"
#include "devices/simulated/profiles.hpp"
#include "devices/simulated/servo_ticks.hpp"

namespace palpate::devices {
namespace {

const Body& jitter_body() {
    static const Body one;
    return one;
}

/// A bare mass of 0.1 kg that only forces move.
const std::string bare =
    "touch,friction=no,encoder=0,force_step=0,hand_mass=0.055,hand_stiffness=0,hand_damping=0,"
    "hand=hold,depth=0,speed=1";

TEST(Jitter, has_the_rates_that_were_measured_of_a_touch) {
    for (const std::uint64_t seed : {0, 1, 2}) {
        ServoTicks ticks(seed);
        double sum = 0, squares = 0, least = 1e9, most = 0;
        constexpr int count = 100'000;
        for (int i = 0; i < count; ++i) {
            const double rate = 1 / ticks.next();
            sum += rate;
            squares += rate * rate;
            least = std::min(least, rate);
            most = std::max(most, rate);
        }
        const double mean = sum / count;
        const double deviation = std::sqrt(squares / count - mean * mean);
        EXPECT_GT(mean, 977);
        EXPECT_LT(mean, 1012);
        EXPECT_GT(deviation, 38);
        EXPECT_LT(deviation, 43);
        EXPECT_NEAR(least, 414, 1e-9);
        EXPECT_NEAR(most, 1237, 1e-9);
    }
}

TEST(Jitter, belongs_to_the_touch_unless_it_is_chosen) {
    const auto ages = [](const std::string& options) {
        const auto device = jitter_body().open(options + ",seconds=1");
        std::set<double> all;
        for (int i = 0; i < 100; ++i) all.insert(device->read(1e-3 * i).age);
        return all.size();
    };
    for (const std::string& name : profile_names()) {
        EXPECT_EQ(ages(name) > 1, name == "touch") << name;
        EXPECT_EQ(ages(name + ",jitter=no"), 1) << name;
        EXPECT_GT(ages(name + ",jitter=yes"), 90) << name;
    }
}

TEST(Jitter, has_the_seed_of_the_hand) {
    const auto ages = [](const std::string& seed) {
        const auto device = jitter_body().open("touch,seconds=1,seed=" + seed);
        std::vector<double> all;
        for (int i = 0; i < 900; ++i) all.push_back(device->read(1e-3 * i).age);
        return all;
    };
    EXPECT_EQ(ages("3"), ages("3"));
    EXPECT_NE(ages("3"), ages("4"));
}

TEST(Jitter, gives_the_pose_of_the_last_tick_and_its_age) {
    const std::string options = "touch,hand=circle,encoder=0,seconds=2,grip=firm,seed=2";
    const auto uneven = jitter_body().open(options);
    const auto even = jitter_body().open(options + ",jitter=no");
    double oldest = 0, moved = 0, last = -1;
    for (int i = 0; i < 1900; ++i) {
        const double time = 1e-3 * i;
        const DeviceReading reading = uneven->read(time);
        ASSERT_EQ(reading.status, DeviceStatus::ready);
        ASSERT_GE(reading.age, 0);
        oldest = std::max(oldest, reading.age);
        if (time - reading.age <= last + 1e-8) continue;  // the tick before
        last = time - reading.age;
        const Vec3 there = even->read(last).position;
        EXPECT_LE((reading.position - there).norm(), 1e-3) << i;
        moved = std::max(moved, (there - even->read(time).position).norm());
        last = time;
    }
    EXPECT_GT(oldest, 1.1e-3);
    EXPECT_LT(oldest, 1 / 414.0);
    EXPECT_GT(moved, 0.02);  // else the tick makes no difference
}

TEST(Jitter, lets_a_force_act_from_the_next_tick_and_no_longer_than_any_other) {
    for (const std::string seed : {"1", "2", "3", "4"}) {
        const auto device = jitter_body().open(bare + ",delay=0,seed=" + seed);
        double time = 0;
        for (; time < 0.05; time += 1e-4) device->read(time);
        const double start = device->read(time).position.x();
        device->write({Vec3(1, 0, 0)}, time);
        const double written = time;
        double tick = 0, at = start, speed = 0, begins = 0, ends = 0;  // ends: it is faster no more
        for (; time < written + 0.06; time += 1e-4) {
            const DeviceReading now = device->read(time);
            const double x = now.position.x(), this_tick = time - now.age;
            if (this_tick < tick + 1e-6) continue;
            const double new_speed = (x - at) / (this_tick - tick);
            if (begins == 0 && x != start) begins = tick;
            if (new_speed > 1.01 * speed) ends = this_tick;
            tick = this_tick;
            at = x;
            speed = new_speed;
        }
        EXPECT_GE(begins, written) << seed;
        EXPECT_LT(begins, written + 1 / 414.0) << seed;
        EXPECT_GT(ends, written + 0.017) << seed;
        EXPECT_LT(ends, written + Device::longest_force + 3 / 414.0) << seed;
    }
}

TEST(Jitter, counts_the_exchange_with_its_servo_as_delay) {
    const double without = jitter_body().open("touch,jitter=no")->info().limits.delay;
    EXPECT_EQ(without, profile("touch").delay);
    EXPECT_EQ(jitter_body().open("touch")->info().limits.delay, without + exchange_delay(1e-3));
}

TEST(Jitter, leaves_a_reading_after_a_gap_fresh_and_no_force_after_stop) {
    const auto device = jitter_body().open(bare + ",delay=0");
    device->read(0);
    EXPECT_EQ(device->read(10).status, DeviceStatus::ready);
    const Vec3 start = device->read(10).position;
    for (int i = 1; i < 100; ++i) {
        device->write({Vec3(1, 0, 0)}, 10 + 1e-3 * i);
        if (i == 1) device->stop();
        device->read(10 + 1e-3 * i);
    }
    EXPECT_LE((device->read(10.1).position - start).norm(), 1e-12);
}

}  // namespace
}  // namespace palpate::devices
