// The link between a backend's thread and the servo: ages, staleness, letting go.
#include "devices/link.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

namespace palpate::devices {
namespace {

using namespace std::chrono_literals;

DeviceReading ready_at(double x) {
    DeviceReading reading;
    reading.position = Vec3(x, 2, 3);
    reading.buttons = 5;
    reading.status = DeviceStatus::ready;
    return reading;
}

TEST(Link, reads_starting_until_the_backend_reports) {
    const Link link;
    EXPECT_EQ(link.read().status, DeviceStatus::starting);
}

TEST(Link, hands_over_the_newest_reading_whole) {
    Link link;
    link.report(ready_at(1));
    link.report(ready_at(7));
    const DeviceReading reading = link.read();
    EXPECT_EQ(reading.position, Vec3(7, 2, 3));
    EXPECT_EQ(reading.buttons, 5U);
    EXPECT_GE(reading.age, 0);
}

TEST(Link, a_reading_that_was_old_when_it_came_is_stale) {
    Link link;
    DeviceReading reading = ready_at(1);
    reading.age = 0.0201;
    link.report(reading);
    EXPECT_EQ(link.read().status, DeviceStatus::stale);
}

TEST(Link, a_reading_whose_age_is_no_finite_number_from_0_never_looks_fresh) {
    Link link;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double age : {-1e-3, -infinity, infinity, std::nan("")}) {
        DeviceReading reading = ready_at(1);
        reading.age = age;
        link.report(reading);
        std::this_thread::sleep_for(5ms);  // -1 ms and 5 ms must not make 4 ms
        EXPECT_EQ(link.read().status, DeviceStatus::stale) << age;
    }
}

TEST(Link, a_reading_goes_stale_and_keeps_its_position) {
    Link link;
    link.report(ready_at(1));
    std::this_thread::sleep_for(25ms);
    EXPECT_EQ(link.read().status, DeviceStatus::stale);
    EXPECT_EQ(link.read().position, Vec3(1, 2, 3));
}

TEST(Link, a_loss_keeps_the_last_position) {
    Link link;
    link.report(ready_at(1));
    link.report(DeviceStatus::lost);
    EXPECT_EQ(link.read().status, DeviceStatus::lost);
    EXPECT_EQ(link.read().position, Vec3(1, 2, 3));
}

bool is_zero(const Wrench& wrench) {
    return wrench.force.isZero(0) && wrench.torque.isZero(0);
}
const Wrench some{Vec3(1, 2, 3), Vec3(40, 50, 60)};

TEST(Link, no_wrench_before_the_first_and_after_the_last_has_aged) {
    Link link;
    EXPECT_TRUE(is_zero(link.wrench()));
    // A machine that stalls between the two lines is told apart from a link that is wrong.
    bool seen = false;
    for (int attempt = 0; attempt < 100 && !seen; ++attempt) {
        link.write(some);
        const Wrench got = link.wrench();
        seen = got.force == some.force && got.torque == some.torque;
    }
    EXPECT_TRUE(seen);
    std::this_thread::sleep_for(21ms);
    EXPECT_TRUE(is_zero(link.wrench()));
}

TEST(Link, a_wrench_of_which_any_number_is_not_finite_is_zero) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Link link;
    for (const double bad : {nan, infinity, -infinity}) {
        link.write({Vec3(1, bad, 3), Vec3(1, 2, 3)});
        EXPECT_TRUE(is_zero(link.wrench()));
        link.write({Vec3(1, 2, 3), Vec3(0, 0, bad)});
        EXPECT_TRUE(is_zero(link.wrench()));
    }
}

TEST(Link, lets_go_for_good_when_stopped) {
    Link link;
    link.write(some);
    link.stop();
    EXPECT_TRUE(is_zero(link.wrench()));
    link.write(some);
    EXPECT_TRUE(is_zero(link.wrench()));
    EXPECT_TRUE(link.stopped());
}

}  // namespace
}  // namespace palpate::devices
