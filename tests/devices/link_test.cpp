// The link between a backend's thread and the servo: ages, staleness, letting go.
#include "devices/link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace palpate::devices {
namespace {

constexpr std::int64_t millisecond = 1'000'000;  // [ns]
constexpr std::int64_t begin = 77'000 * millisecond;

DeviceReading ready_at(double x) {
    DeviceReading reading;
    reading.position = Vec3(x, 2, 3);
    reading.buttons = 5;
    reading.status = DeviceStatus::ready;
    return reading;
}

TEST(Link, reads_starting_until_the_backend_reports) {
    const Link link;
    EXPECT_EQ(link.read(begin).status, DeviceStatus::starting);
}

TEST(Link, hands_over_the_newest_reading_whole) {
    Link link;
    link.report(ready_at(1), begin);
    link.report(ready_at(7), begin + millisecond);
    const DeviceReading reading = link.read(begin + 3 * millisecond);
    EXPECT_EQ(reading.position, Vec3(7, 2, 3));
    EXPECT_EQ(reading.buttons, 5U);
    EXPECT_NEAR(reading.age, 0.002, 1e-15);
    EXPECT_EQ(link.read(begin).age, 0);  // of two threads' clocks one may be behind
}

TEST(Link, a_reading_that_was_old_when_it_came_is_stale) {
    Link link;
    DeviceReading reading = ready_at(1);
    reading.age = 0.0201;
    link.report(reading, begin);
    EXPECT_EQ(link.read(begin).status, DeviceStatus::stale);
    reading.age = 0.015;
    link.report(reading, begin);
    EXPECT_EQ(link.read(begin + 4 * millisecond).status, DeviceStatus::ready);
    EXPECT_EQ(link.read(begin + 6 * millisecond).status, DeviceStatus::stale);
}

TEST(Link, a_reading_whose_age_is_no_finite_number_from_0_never_looks_fresh) {
    Link link;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double age : {-1e-3, -infinity, infinity, std::nan("")}) {
        DeviceReading reading = ready_at(1);
        reading.age = age;
        link.report(reading, begin);
        // -1 ms and 5 ms must not make 4 ms.
        EXPECT_EQ(link.read(begin + 5 * millisecond).status, DeviceStatus::stale) << age;
    }
}

TEST(Link, a_reading_goes_stale_and_keeps_its_position) {
    Link link;
    link.report(ready_at(1), begin);
    EXPECT_EQ(link.read(begin + 20 * millisecond).status, DeviceStatus::ready);
    EXPECT_EQ(link.read(begin + 20 * millisecond + 1).status, DeviceStatus::stale);
    EXPECT_EQ(link.read(begin + 25 * millisecond).position, Vec3(1, 2, 3));
}

TEST(Link, a_loss_keeps_the_last_position) {
    Link link;
    link.report(ready_at(1), begin);
    link.report(DeviceStatus::lost, begin);
    EXPECT_EQ(link.read(begin + 100 * millisecond).status, DeviceStatus::lost);
    EXPECT_EQ(link.read(begin).position, Vec3(1, 2, 3));
}

bool is_zero(const Wrench& wrench) {
    return wrench.force.isZero(0) && wrench.torque.isZero(0);
}
const Wrench some{Vec3(1, 2, 3), Vec3(40, 50, 60)};

TEST(Link, no_wrench_before_the_first_and_after_the_last_has_aged) {
    Link link;
    EXPECT_TRUE(is_zero(link.wrench(begin)));
    link.write(some, begin);
    for (const std::int64_t age : {std::int64_t{0}, 20 * millisecond}) {
        EXPECT_EQ(link.wrench(begin + age).force, some.force);
        EXPECT_EQ(link.wrench(begin + age).torque, some.torque);
    }
    EXPECT_TRUE(is_zero(link.wrench(begin + 20 * millisecond + 1)));
}

TEST(Link, a_wrench_of_which_any_number_is_not_finite_is_zero) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Link link;
    for (const double bad : {nan, infinity, -infinity}) {
        link.write({Vec3(1, bad, 3), Vec3(1, 2, 3)}, begin);
        EXPECT_TRUE(is_zero(link.wrench(begin)));
        link.write({Vec3(1, 2, 3), Vec3(0, 0, bad)}, begin);
        EXPECT_TRUE(is_zero(link.wrench(begin)));
    }
}

TEST(Link, lets_go_for_good_when_stopped) {
    Link link;
    link.write(some, begin);
    link.stop();
    EXPECT_TRUE(is_zero(link.wrench(begin)));
    EXPECT_TRUE(link.stopping());  // the zero may still be on its way
    link.write(some, begin);
    EXPECT_TRUE(is_zero(link.wrench(begin)));
    EXPECT_TRUE(link.stopped());
    EXPECT_FALSE(link.stopping());
}

TEST(MachineTiming, sleeps_until_its_own_clock_shows_the_time) {
    const Timing machine;
    const std::int64_t until = machine.now() + millisecond;
    machine.sleep_until(until);
    EXPECT_GE(machine.now(), until);
}

}  // namespace
}  // namespace palpate::devices
