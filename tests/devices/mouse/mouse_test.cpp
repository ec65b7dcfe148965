// The hand that follows a window's pointer.
#include "palpate/devices/mouse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/devices/options.hpp"
#include "support/allocation_counter.hpp"

namespace palpate::devices {
namespace {

constexpr double tick = 1e-3;

TEST(Mouse, hand_comes_to_rest_where_the_pointer_aims) {
    Mouse mouse(600);
    mouse.aim({10, -20, 5});
    Vec3 at = Vec3::Zero();
    for (int i = 0; i < 1000; ++i) at = mouse.read(i * tick).position;
    EXPECT_NEAR((at - Vec3(10, -20, 5)).norm(), 0, 1e-6);
}

TEST(Mouse, hand_is_near_within_a_tenth_of_a_second_and_never_beyond) {
    Mouse mouse(600);
    mouse.read(0);
    mouse.aim({0, 0, 90});
    for (int i = 1; i <= 1000; ++i) {
        const Vec3 at = mouse.read(i * tick).position;
        EXPECT_GE(at[2], 90 - 1e-9) << "tick " << i;
        if (i == 100) {
            EXPECT_LT(at[2], 90.2);  // 2 % of the way
        }
    }
}

TEST(Mouse, hand_is_never_faster_than_its_speed_however_the_pointer_jumps) {
    Mouse mouse(300);
    Vec3 last = mouse.read(0).position;
    double farthest = 0;
    for (int i = 1; i < 3000; ++i) {
        if (i % 50 == 0) mouse.aim(Vec3(100, 100, 100) * ((i / 50) % 2 == 0 ? 1 : -1));
        const Vec3 at = mouse.read(i * tick).position;
        EXPECT_LE((at - last).norm(), 300 * tick * (1 + 1e-9));
        farthest = std::max(farthest, (at - last).norm());
        last = at;
    }
    EXPECT_GT(farthest, 0.29) << "the speed was never reached: the test shows nothing";
}

TEST(Mouse, aim_stays_within_twice_the_workspace_and_what_is_not_finite_is_passed_over) {
    Mouse mouse(600);
    mouse.aim({1e6, -1e6, 0});
    EXPECT_EQ(mouse.aimed(), Vec3(160, -160, 0));
    mouse.aim({std::numeric_limits<double>::quiet_NaN(), 0, 0});
    EXPECT_EQ(mouse.aimed(), Vec3(160, -160, 0));
    for (int i = 0; i < 2000; ++i) mouse.read(i * tick);
    EXPECT_NEAR((mouse.read(2).position - Vec3(160, -160, 0)).norm(), 0, 1e-6);
}

TEST(Mouse, hand_waits_before_the_person_and_is_ready_from_the_first_read) {
    Mouse mouse(600);
    const DeviceReading reading = mouse.read(0);
    EXPECT_EQ(reading.status, DeviceStatus::ready);
    EXPECT_EQ(reading.position, Vec3(0, 0, 1.25 * mouse.info().workspace_high[2]));
}

TEST(Mouse, a_stalled_loop_moves_the_hand_no_farther_than_a_short_gap) {
    Mouse mouse(600);
    mouse.read(0);
    mouse.aim({-100, 0, 0});
    const Vec3 before = mouse.read(tick).position;
    EXPECT_LE((mouse.read(10).position - before).norm(), 600 * 0.02 * (1 + 1e-9));
}

TEST(Mouse, reading_allocates_nothing) {
    Mouse mouse(600);
    mouse.aim({1, 2, 3});
    const std::int64_t before = support::allocation_count();
    for (int i = 0; i < 1000; ++i) mouse.read(i * tick);
    EXPECT_EQ(support::allocation_count(), before);
}

TEST(Mouse, options_out_of_range_are_refused_by_name) {
    const Field field =
        linear_field(Volume(Geometry{.size = {2, 2, 2}}, std::vector<std::uint8_t>(8)));
    const DeviceScene scene{field, 1, 1000, {}};
    EXPECT_THROW(open_mouse(parse_device("mouse:speed=0"), scene), std::invalid_argument);
    EXPECT_THROW(open_mouse(parse_device("mouse:sped=5"), scene), std::invalid_argument);
    EXPECT_NE(open_mouse(parse_device("mouse:speed=100"), scene), nullptr);
}

TEST(Mouse, hand_turns_to_where_it_is_asked_smoothly_and_by_the_shortest_way) {
    Mouse mouse(600);
    EXPECT_TRUE(mouse.info().has_orientation);
    EXPECT_EQ(mouse.read(0).orientation, Mat3::Identity());
    const Quaternion half(Eigen::AngleAxisd(3, Vec3(1, 2, 3).normalized()));
    mouse.turn(half);
    Quaternion last = Quaternion::Identity();
    double fastest = 0;
    for (int i = 1; i < 1500; ++i) {
        const Quaternion at(mouse.read(i * tick).orientation);
        fastest = std::max(fastest, at.angularDistance(last) / tick);
        EXPECT_LE(at.angularDistance(Quaternion::Identity()), 3 + 1e-6);
        last = at;
    }
    EXPECT_NEAR(last.angularDistance(half), 0, 1e-6);
    EXPECT_LE(fastest, 4 * std::acos(-1.0) * (1 + 1e-6)) << "two turns a second";
    EXPECT_GT(fastest, 10);
    mouse.turn(Quaternion(0, 0, 0, 0));
    mouse.turn(Quaternion(std::numeric_limits<double>::quiet_NaN(), 0, 0, 1));
    EXPECT_NEAR(mouse.turned_to().angularDistance(half), 0, 1e-9) << "no orientations";
}

}  // namespace
}  // namespace palpate::devices
