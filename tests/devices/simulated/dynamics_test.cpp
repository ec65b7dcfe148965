// The physics of the simulated device against closed forms.
#include "devices/simulated/dynamics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "support/random.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {
namespace {

using support::Random;

const Vec3 zero = Vec3::Zero();

/// [N mm] of motion and of the hand's spring, with the target at the origin.
double energy(const HandAndDevice& s) {
    return 0.5e-3 * s.mass * s.velocity.squaredNorm() +
           0.5 * s.hand_stiffness * s.position.squaredNorm();
}

/// Greatest distance [mm] from the analytic solution over 0.5 s after letting go 5 mm away.
double greatest_error(double dt) {
    HandAndDevice s{.mass = 0.145,
                    .damping = 0.5e-3,
                    .hand_damping = 2e-3,
                    .hand_stiffness = 0.3,
                    .position = {3, -4, 0}};
    const Vec3 start = s.position;
    const double mass = 1e-3 * s.mass;
    const double decay = (s.damping + s.hand_damping) / (2 * mass);
    const double turn = std::sqrt(s.hand_stiffness / mass - decay * decay);
    double worst = 0;
    const int steps = static_cast<int>(std::round(0.5 / dt));
    for (int i = 1; i <= steps; ++i) {
        advance(s, zero, zero, zero, dt);
        const double t = i * dt;
        const double part =
            std::exp(-decay * t) * (std::cos(turn * t) + decay / turn * std::sin(turn * t));
        worst = std::max(worst, (s.position - part * start).norm());
    }
    return worst;
}

TEST(HandAndDevice, swings_as_the_analytic_mass_spring_damper_does) {
    EXPECT_LE(greatest_error(longest_step), 0.01);  // of 5 mm
}

TEST(HandAndDevice, errs_by_half_as_much_at_half_the_step) {
    EXPECT_NEAR(greatest_error(1e-4) / greatest_error(5e-5), 2, 0.1);
}

TEST(HandAndDevice, rests_where_spring_and_force_balance) {
    HandAndDevice s{.mass = 0.1, .damping = 1e-3, .hand_damping = 9e-3, .hand_stiffness = 0.5};
    for (int i = 0; i < 200000; ++i) advance(s, {1, 2, 3}, zero, {0, 0.25, -1}, longest_step);
    EXPECT_TRUE(s.position.isApprox(Vec3(1, 2.5, 1), 1e-9)) << s.position.transpose();
}

TEST(HandAndDevice, lags_behind_a_moving_target_by_what_the_device_damps) {
    HandAndDevice s{.mass = 0.1, .damping = 1e-3, .hand_damping = 9e-3, .hand_stiffness = 0.5};
    const Vec3 speed(50, 0, 0);
    Vec3 target = zero;
    for (int i = 1; i <= 100000; ++i) {
        target = speed * (i * longest_step);
        advance(s, target, speed, zero, longest_step);
    }
    EXPECT_NEAR((target - s.position)[0], 1e-3 * 50 / 0.5, 1e-6);
}

TEST(HandAndDevice, never_gains_energy_by_itself) {
    Random random(7);
    int slid = 0, stopped = 0;
    for (int run = 0; run < support::scaled(400); ++run) {
        HandAndDevice s{.mass = std::pow(10, random.uniform(-3, 1)),
                        .damping = random.chance(0.3) ? 0 : std::pow(10, random.uniform(-5, 0)),
                        .friction = random.chance(0.3) ? 0 : std::pow(10, random.uniform(-3, 1)),
                        .hand_damping = random.chance(0.3) ? 0 : random.uniform(0, 1),
                        .hand_stiffness = random.chance(0.2) ? 0 : random.uniform(0, 100),
                        .position = random.point(-20, 20),
                        .velocity = random.point(-2000, 2000)};
        const double dt = std::pow(10, random.uniform(-7, -1));
        double before = energy(s);
        for (int i = 0; i < 300; ++i) {
            advance(s, zero, zero, zero, dt);
            const double now = energy(s);
            ASSERT_TRUE(s.position.allFinite());
            ASSERT_LE(now, before * (1 + 1e-12)) << "run " << run << ", step " << i;
            before = now;
            ++(s.velocity.isZero(0) ? stopped : slid);
        }
    }
    EXPECT_GT(slid, 1000);
    EXPECT_GT(stopped, 1000);
}

TEST(HandAndDevice, friction_holds_below_its_threshold_and_lets_go_above) {
    HandAndDevice s{.mass = 0.1, .friction = 0.26, .position = {0.1, 0.2, 0.3}};
    const Vec3 along = Vec3(1, -2, 2) / 3;
    for (int i = 0; i < 10000; ++i) advance(s, zero, zero, 0.2599 * along, longest_step);
    EXPECT_EQ(s.position, Vec3(0.1, 0.2, 0.3));
    for (int i = 0; i < 10000; ++i) advance(s, zero, zero, 0.2601 * along, longest_step);
    // 1e-4 N on 0.1 kg for 0.25 s.
    EXPECT_NEAR((s.position - Vec3(0.1, 0.2, 0.3)).dot(along), 0.5 * 1 * 0.0625, 1e-4);
}

TEST(HandAndDevice, friction_stops_it_where_the_energy_is_used_up_and_for_good) {
    HandAndDevice s{.mass = 0.2, .friction = 0.5, .velocity = {0, 60, 80}};
    int moving = 0;
    for (int i = 0; i < 20000; ++i) {
        advance(s, zero, zero, zero, longest_step);
        moving += !s.velocity.isZero(0);
    }
    // v^2 m / 2 F and m v / F.
    EXPECT_NEAR(s.position.norm(), 100 * 100 * 0.2e-3 / (2 * 0.5), 2e-3);
    EXPECT_NEAR(moving * longest_step, 0.2e-3 * 100 / 0.5, 2 * longest_step);
    EXPECT_EQ(s.velocity, zero);
}

TEST(HandAndDevice, friction_leaves_a_spring_stretched_by_no_more_than_it_can_hold) {
    HandAndDevice s{.mass = 0.1,
                    .friction = 0.3,
                    .hand_damping = 1e-3,
                    .hand_stiffness = 0.5,
                    .position = {10, 0, 0}};
    for (int i = 0; i < 100000; ++i) advance(s, zero, zero, zero, longest_step);
    EXPECT_EQ(s.velocity, zero);
    EXPECT_LE(0.5 * s.position.norm(), 0.3);
    EXPECT_GT(s.position.norm(), 0.01);  // it did stick on the way
}

TEST(HandAndDevice, slides_alike_in_every_direction) {
    const Vec3 along = Vec3(2, 3, -6) / 7;
    HandAndDevice slanted{.mass = 0.1, .friction = 0.2, .velocity = 100 * along};
    HandAndDevice straight{.mass = 0.1, .friction = 0.2, .velocity = {100, 0, 0}};
    for (int i = 0; i < 1000; ++i) {
        advance(slanted, zero, zero, 0.15 * along, longest_step);
        advance(straight, zero, zero, {0.15, 0, 0}, longest_step);
    }
    EXPECT_TRUE(slanted.position.isApprox(straight.position[0] * along, 1e-12));
}

TEST(MotorForce, is_what_was_asked_for_in_whole_steps_and_never_above_the_limit) {
    DeviceProfile device;
    device.maximum_force = 3.3;
    device.force_step = 0.25;
    EXPECT_EQ(motor_force(device, {1.12, -1.13, 0.3}), Vec3(1, -1.25, 0.25));
    Random random(3);
    int limited = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 force = random.uniform(0, 8) * random.direction();
        const Vec3 given = motor_force(device, force);
        ASSERT_LE(given.norm(), 3.3);
        ASSERT_EQ(given, 0.25 * (given / 0.25).array().rint().matrix());
        const double off = (given - force).cwiseAbs().maxCoeff();
        ASSERT_LE(force.norm() <= 3 ? off : 0, 0.125 + 1e-12);
        limited += force.norm() > 3.3;
    }
    EXPECT_GT(limited, 500);
    device.force_step = 0;
    EXPECT_EQ(motor_force(device, {0.123, 0, 0}), Vec3(0.123, 0, 0));
    EXPECT_TRUE(motor_force(device, {0, 1e200, 0}).isApprox(Vec3(0, 3.3, 0)));
}

TEST(MotorForce, is_nothing_for_a_force_that_is_not_finite) {
    const DeviceProfile& device = profile("omni");
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(motor_force(device, {1, nan, 1}), zero);
    EXPECT_EQ(motor_force(device, {0, nan, 0}), zero);
    EXPECT_EQ(motor_force(device, {infinity, 0, 0}), zero);
    EXPECT_EQ(motor_force(device, {-infinity, infinity, 0}), zero);
}

TEST(EncoderPosition, is_the_nearest_whole_step) {
    DeviceProfile device;
    device.encoder_step = 0.5;
    EXPECT_EQ(encoder_position(device, {0.24, 0.26, -7.8}), Vec3(0, 0.5, -8));
    device.encoder_step = 0;
    EXPECT_EQ(encoder_position(device, {0.24, 0.26, -7.8}), Vec3(0.24, 0.26, -7.8));
}

TEST(WrenchLine, a_force_acts_from_its_delay_until_the_next_or_until_it_is_too_old) {
    WrenchLine line(0.25, 2, 8);
    EXPECT_EQ(line.at(0).wrench.force, zero);
    EXPECT_EQ(line.at(0).until, std::numeric_limits<double>::infinity());
    line.send({Vec3(1, 0, 0)}, 1);
    line.send({Vec3(2, 0, 0)}, 2);
    EXPECT_EQ(line.at(1).wrench.force, zero);
    EXPECT_EQ(line.at(1).until, 1.25);
    EXPECT_EQ(line.at(1.25).wrench.force, Vec3(1, 0, 0));
    EXPECT_EQ(line.at(1.25).until, 2.25);
    EXPECT_EQ(line.at(2.25).wrench.force, Vec3(2, 0, 0));
    EXPECT_EQ(line.at(2.25).until, 4.25);
    EXPECT_EQ(line.at(4.25).wrench.force, zero);
    line.send({Vec3(3, 0, 0)}, 5);
    EXPECT_EQ(line.at(5).wrench.force, zero);
    EXPECT_EQ(line.at(5.25).wrench.force, Vec3(3, 0, 0));
}

TEST(WrenchLine, gives_the_newest_of_those_that_arrived_and_replaces_when_it_is_full) {
    WrenchLine line(1, 100, 2);
    for (int i = 1; i <= 5; ++i) line.send({Vec3(double(i), 0, 0)}, 0.1 * i);
    EXPECT_EQ(line.at(1.2).wrench.force, Vec3(1, 0, 0));
    EXPECT_EQ(line.at(1.6).wrench.force, Vec3(5, 0, 0));
    for (int i = 1; i <= 100; ++i) {  // round the ring
        line.send({Vec3(double(i), 0, 0)}, 10 + i);
        ASSERT_EQ(line.at(11 + i).wrench.force, Vec3(i, 0, 0));
    }
}

TEST(WrenchLine, a_time_that_goes_back_or_is_not_a_number_counts_as_the_last_one) {
    WrenchLine line(0, 10, 8);
    line.send({Vec3(1, 0, 0)}, 5);
    line.send({Vec3(2, 0, 0)}, 3);
    EXPECT_EQ(line.at(4.9).wrench.force, zero);
    EXPECT_EQ(line.at(5).wrench.force, Vec3(2, 0, 0));
    line.send({Vec3(3, 0, 0)}, std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(line.at(5).wrench.force, Vec3(3, 0, 0));
}

TEST(Profiles, are_found_by_name_and_make_sense) {
    for (const std::string& name : profile_names()) {
        const DeviceProfile& one = profile(name);
        EXPECT_EQ(one.name, name);
        EXPECT_GT(one.mass, 0);
        EXPECT_GT(one.maximum_force, 0);
        EXPECT_GT(one.stiffness, 0);
        EXPECT_GT((one.workspace_high - one.workspace_low).minCoeff(), 10);
        EXPECT_LT(one.encoder_step, 0.1);
        EXPECT_LT(one.delay, 0.01);
    }
    for (const std::string& name : grip_names()) EXPECT_GT(grip(name).damping, 0);
    EXPECT_EQ(
        support::message_of<std::invalid_argument>([] { profile("novint"); }),
        "there is no device profile 'novint': use one of omni, touch, touchx, omega3, omega6, "
        "omega7, sigma7, premium6dof, falcon, inverse3, inverse3_versegrip");
    EXPECT_EQ(support::message_of<std::invalid_argument>([] { grip("tight"); }),
              "there is no grip 'tight': use one of light, normal, firm (did you mean light?)");
}

}  // namespace
}  // namespace palpate::devices
