// The Falcon's kinematics: inverse, forward and forces agree with each other and with figures that
// were computed by Stamper's equations.
#include "devices/falcon/kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/constants.hpp"
#include "support/random.hpp"

namespace palpate::devices::falcon {
namespace {

using support::Random;

/// [m] anywhere in the cube of 80 mm.
Vec3 any_place(Random& random) {
    return centre + random.point(-0.04, 0.04);
}

TEST(FalconKinematics, angles_are_those_of_stampers_equations) {
    constexpr double degree = std::numbers::pi / 180;
    const struct {
        Vec3 position, degrees;
    } known[] = {{{0, 0, 0.08}, {-14.338, -14.338, -14.338}},
                 {{0, 0, 0.125}, {26.299, 26.299, 26.299}},
                 {{0, 0, 0.17}, {65.575, 65.575, 65.575}},
                 {{0.03, 0.02, 0.11}, {12.341, 4.635, 42.031}},
                 {{-0.04, 0.04, 0.12}, {4.399, 62.372, 37.504}}};
    for (const auto& [position, degrees] : known) {
        const auto angles = angles_at(position);
        ASSERT_TRUE(angles) << position.transpose();
        EXPECT_LT((*angles / degree - degrees).cwiseAbs().maxCoeff(), 6e-4) << position.transpose();
    }
}

TEST(FalconKinematics, the_position_with_the_angles_of_a_place_is_that_place) {
    Random random(1);
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 place = any_place(random);
        const auto angles = angles_at(place);
        ASSERT_TRUE(angles) << place.transpose();
        const auto from_centre = position_with(*angles, centre);
        ASSERT_TRUE(from_centre) << place.transpose();
        ASSERT_LT((*from_centre - place).norm(), 1e-8) << place.transpose();
        const auto from_near = position_with(*angles, place + random.point(-0.01, 0.01));
        if (from_near) {
            ASSERT_LT((*from_near - place).norm(), 1e-8) << place.transpose();
        }
    }
}

TEST(FalconKinematics, gradients_of_the_angles_are_their_differences) {
    Random random(2);
    constexpr double step = 1e-6;  // [m]
    for (int i = 0; i < 5000; ++i) {
        const Vec3 place = any_place(random);
        const auto gradients = angle_gradients(place);
        ASSERT_TRUE(gradients) << place.transpose();
        Mat3 differences;
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3 way = step * Vec3::Unit(axis);
            const auto above = angles_at(place + way), below = angles_at(place - way);
            ASSERT_TRUE(above && below);
            differences.col(axis) = (*above - *below) / (2 * step);
        }
        ASSERT_LT((*gradients - differences).norm(), 1e-4 * gradients->norm()) << place.transpose();
    }
}

TEST(FalconKinematics, torques_do_the_work_of_the_force) {
    Random random(3);
    for (int i = 0; i < 5000; ++i) {
        const Vec3 place = any_place(random);
        const Vec3 force = 8 * random.direction();
        const auto torques = torques_for(force, place);
        ASSERT_TRUE(torques) << place.transpose();
        const Vec3 way = 1e-6 * random.direction();
        const Vec3 turn = *angles_at(place + way) - *angles_at(place - way);
        ASSERT_NEAR(torques->dot(turn), force.dot(2 * way), 1e-9) << place.transpose();
    }
}

TEST(FalconKinematics, what_no_leg_can_reach_has_no_angles) {
    const double nan = support::not_a_number;
    for (const Vec3& far :
         {Vec3(0, 0, 0.3), Vec3(0.2, 0, 0.1), Vec3(nan, 0, 0.1), Vec3(0, 0, nan)}) {
        EXPECT_FALSE(angles_at(far)) << far.transpose();
        EXPECT_FALSE(angle_gradients(far)) << far.transpose();
        EXPECT_FALSE(torques_for(Vec3(1, 0, 0), far)) << far.transpose();
    }
    EXPECT_FALSE(position_with(Vec3(3, -3, 3), centre));
    EXPECT_FALSE(position_with(Vec3(nan, 0, 0), centre));
}

TEST(FalconKinematics, no_angles_whatever_lead_to_a_position_that_does_not_have_them) {
    Random random(4);
    int found = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 angles = random.point(-3, 3);
        const auto position = position_with(angles, centre);
        if (!position) continue;
        ++found;
        ASSERT_LT((*angles_at(*position) - angles).norm(), 1e-6);
    }
    EXPECT_GT(found, 100);
}

TEST(FalconKinematics, encoders_count_a_twenty_seventh_of_a_degree) {
    EXPECT_NEAR(angles_from({0, 0, 0})[0], 35 * std::numbers::pi / 180, 1e-12);
    EXPECT_NEAR((angles_from({1000, 0, -1000}) - angles_from({0, 0, 0}))[0],
                36.4347 * std::numbers::pi / 180, 1e-5);
    Random random(5);
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector3i encoders(random.below(3000) - 1500, random.below(3000) - 1500, 7);
        ASSERT_EQ(encoders_at(angles_from(encoders)), encoders);
    }
}

}  // namespace
}  // namespace palpate::devices::falcon
