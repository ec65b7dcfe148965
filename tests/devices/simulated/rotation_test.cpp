// The simulated device and hand as they turn: the physics in closed form, torque, orientation, and
// the loop with the force stage at the bound of check().
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "devices/simulated/closed_loop.hpp"
#include "devices/simulated/dynamics.hpp"
#include "support/allocation_counter.hpp"
#include "support/random.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {
namespace {

using support::Random;

const Vec3 still = Vec3::Zero();
const Quaternion straight = Quaternion::Identity();
constexpr double degree = std::numbers::pi / 180;

/// [N mm] of rotation and of the hand's spring, with a straight target.
double turning_energy(const TurningHandAndDevice& s) {
    return 0.5e-3 * s.inertia * s.velocity.squaredNorm() +
           0.5 * s.hand_stiffness * rotation_between(s.orientation, straight).squaredNorm();
}

TEST(TurningHandAndDevice, swings_as_the_analytic_inertia_spring_damper_does) {
    const Vec3 axis = Vec3(2, -1, 2) / 3;
    TurningHandAndDevice s{.inertia = 40,
                           .damping = 0.1,
                           .hand_damping = 0.3,
                           .hand_stiffness = 100,
                           .orientation = turned(straight, 0.5 * axis)};
    const double decay = 0.4 / (2 * 0.04), turn = std::sqrt(100 / 0.04 - decay * decay);
    double worst = 0;
    for (int i = 1; i <= 20000; ++i) {
        advance(s, straight, still, still, longest_step);
        const double t = i * longest_step;
        const double part =
            std::exp(-decay * t) * (std::cos(turn * t) + decay / turn * std::sin(turn * t));
        const Vec3 now = rotation_between(straight, s.orientation);
        worst = std::max(worst, (now - 0.5 * part * axis).norm());
    }
    EXPECT_LE(worst, 0.002);
    EXPECT_NEAR(s.orientation.norm(), 1, 1e-12);
}

TEST(TurningHandAndDevice, never_gains_energy_by_itself_whatever_its_axis) {
    Random random(11);
    int slid = 0, stopped = 0;
    for (int run = 0; run < support::scaled(300); ++run) {
        TurningHandAndDevice s{.inertia = std::pow(10, random.uniform(-1, 3)),
                               .damping = random.chance(0.3) ? 0 : random.uniform(0, 2),
                               .friction = random.chance(0.3) ? 0 : random.uniform(0, 50),
                               .hand_damping = random.chance(0.3) ? 0 : random.uniform(0, 5),
                               .hand_stiffness = random.uniform(0, 1000),
                               .orientation = turned(straight, random.point(-1.5, 1.5)),
                               .velocity = random.point(-50, 50)};
        const double dt = std::pow(10, random.uniform(-6, -2));
        double before = turning_energy(s);
        for (int i = 0; i < 200; ++i) {
            advance(s, straight, still, still, dt);
            const double now = turning_energy(s);
            ASSERT_LE(now, before * (1 + 1e-12) + 1e-12) << "run " << run << ", step " << i;
            before = now;
            ++(s.velocity.isZero(0) ? stopped : slid);
        }
    }
    EXPECT_GT(slid, support::scaled(1000));
    EXPECT_GT(stopped, support::scaled(1000));
}

TEST(TurningHandAndDevice, friction_holds_below_its_threshold_and_lets_go_above) {
    const Quaternion held = turned(straight, Vec3(0.1, 0.2, 0.3));
    TurningHandAndDevice s{.inertia = 20, .friction = 2, .orientation = held};
    for (int i = 0; i < 1000; ++i) advance(s, straight, still, {0, 1.999, 0}, longest_step);
    EXPECT_EQ(s.orientation.coeffs(), held.coeffs());
    for (int i = 0; i < 4000; ++i) advance(s, straight, still, {0, 3, 0}, longest_step);
    // 1 N mm on 20 kg mm^2 for 0.1 s.
    EXPECT_NEAR(rotation_between(held, s.orientation)[1], 0.5 * 50 * 0.01, 1e-3);
}

TEST(TurningHandAndDevice, lags_behind_a_turning_target_by_what_the_device_damps) {
    TurningHandAndDevice s{.inertia = 20, .damping = 0.2, .hand_damping = 2, .hand_stiffness = 100};
    const Vec3 speed(0, 0, 2);
    Quaternion target = straight;
    for (int i = 1; i <= 40000; ++i) {
        target = turned(straight, speed * (i * longest_step));
        advance(s, target, speed, still, longest_step);
    }
    EXPECT_NEAR(rotation_between(s.orientation, target)[2], 0.2 * 2 / 100, 1e-5);
}

TEST(MotorTorque, is_limited_and_in_whole_steps_and_nothing_without_motors) {
    DeviceProfile device = profile("sigma7");
    device.torque_step = 0.5;
    EXPECT_EQ(motor_torque(device, {1.2, -1.3, 0.1}), Vec3(1, -1.5, 0));
    device.torque_step = 0;
    EXPECT_TRUE(motor_torque(device, {0, 0, 1e9}).isApprox(Vec3(0, 0, device.maximum_torque)));
    EXPECT_EQ(motor_torque(device, {0, std::numeric_limits<double>::quiet_NaN(), 0}), still);
    EXPECT_EQ(motor_torque(profile("omega7"), {0, 0, 100}), still);
}

TEST(EncoderOrientation, is_in_whole_steps_of_angle) {
    DeviceProfile device;
    device.angle_step = 0.1;
    const Quaternion read = encoder_orientation(device, turned(straight, Vec3(0.26, 0, 0)));
    EXPECT_NEAR(rotation_between(straight, read)[0], 0.3, 1e-12);
    Random random(5);
    for (int i = 0; i < 1000; ++i) {
        const Quaternion q = turned(straight, random.point(-1.7, 1.7));
        ASSERT_LE(rotation_between(encoder_orientation(device, q), q).norm(), 0.0867);
    }
    device.angle_step = 0;
    EXPECT_EQ(encoder_orientation(device, read).coeffs(), read.coeffs());
}

const Body& turning_body() {
    static const Body one;
    return one;
}

/// The rotation vector that a reading tells [rad].
Vec3 turn_of(const DeviceReading& reading) {
    return rotation_between(straight, Quaternion(reading.orientation));
}

/// An inertia of 40 kg mm^2 that nobody turns and nothing rounds.
const std::string spinning =
    "sigma7,friction=no,angle_step=0,torque_step=0,delay=0,hand_inertia=0,hand_turn_damping=0,"
    "hand_turn_stiffness=0";

TEST(SimulatedTurns, says_what_its_profile_can_do) {
    for (const std::string& name : profile_names()) {
        const DeviceProfile& one = profile(name);
        const DeviceInfo info = turning_body().open(name + ",grip=light")->info();
        EXPECT_EQ(info.has_orientation, one.has_orientation) << name;
        EXPECT_EQ(info.renders_torque, one.maximum_torque > 0) << name;
        EXPECT_EQ(info.limits.maximum_torque, one.maximum_torque) << name;
        EXPECT_NO_THROW(check(info.limits));
        if (!one.has_orientation) continue;
        EXPECT_GT(one.inertia, 0);
        EXPECT_LT(one.angle_step, 0.2 * degree);
        EXPECT_EQ(info.limits.physical_rotational_damping,
                  one.rotational_damping + grip("light").rotational_damping);
    }
    EXPECT_TRUE(profile("sigma7").maximum_torque > 0 && profile("premium6dof").maximum_torque > 0);
    EXPECT_FALSE(profile("omega3").has_orientation);
}

TEST(SimulatedTurns, the_hand_turns_the_handle_and_stays_or_sways) {
    const std::string turn = "omega7,friction=no,angle_step=0,turn=40,turn_time=1,turn_axis=y";
    const auto stays = turning_body().open(turn), sways = turning_body().open(turn + ",sway=yes");
    Vec3 first = still, second = still, third = still;
    for (int i = 0; i <= 4000; ++i) {
        const Vec3 one = turn_of(stays->read(i / 1000.0));
        const Vec3 other = turn_of(sways->read(i / 1000.0));
        if (i == 1000) first = other;
        if (i == 2000) second = other;
        third = one;
    }
    EXPECT_LE((third - Vec3(0, 40 * degree, 0)).norm(), 0.01);
    EXPECT_LE((first - Vec3(0, 40 * degree, 0)).norm(), 0.03);
    EXPECT_LE(second.norm(), 0.03);
}

TEST(SimulatedTurns, a_torque_turns_the_inertia_by_newtons_law_but_not_beyond_the_limit) {
    const auto turned_by = [](const Vec3& torque) {
        const auto device = turning_body().open(spinning);
        device->read(0);
        device->write({Vec3::Zero(), torque}, 0);
        return turn_of(device->read(0.015));
    };
    // 0.04 N mm s^2 and 0.2 N mm s: their quotient is 0.2 s.
    const double way = 100 / 0.2 * (0.015 - 0.2 * (1 - std::exp(-0.015 / 0.2)));
    const Vec3 turn = turned_by({0, 0, 100});
    EXPECT_NEAR(turn[2], way, 3e-3 * way);
    EXPECT_LE(turn.head<2>().norm(), 1e-12);
    EXPECT_EQ(turned_by({0, 0, 400}), turned_by({0, 0, 1e7}));
    EXPECT_EQ(turned_by({0, std::numeric_limits<double>::infinity(), 0}), still);
}

TEST(SimulatedTurns, no_torque_after_stop_none_from_an_old_wrench_and_none_on_one_without) {
    const auto stopped = turning_body().open(spinning);
    stopped->read(0);
    stopped->write({Vec3::Zero(), Vec3(50, 0, 0)}, 0);
    stopped->stop();
    EXPECT_EQ(turn_of(stopped->read(0.04)), still);
    const auto old = turning_body().open(spinning);
    old->read(0);
    old->write({Vec3::Zero(), Vec3(1, 0, 0)}, 0);
    old->read(0.02);
    const double before = turn_of(old->read(0.02))[0], after = turn_of(old->read(0.04))[0];
    // At 0.02 s it turns with w; from then on the device's damping alone acts.
    const double speed = 1 / 0.2 * (1 - std::exp(-0.02 / 0.2));
    EXPECT_NEAR(after - before, speed * 0.2 * (1 - std::exp(-0.02 / 0.2)), 2e-3 * (after - before));
    const auto passive = turning_body().open("omega6,angle_step=0,friction=no");
    passive->read(0);
    passive->write({Vec3::Zero(), Vec3(50, 0, 0)}, 0);
    EXPECT_EQ(turn_of(passive->read(0.02)), still);
}

TEST(SimulatedTurns, reads_and_writes_allocate_nothing) {
    const auto device = turning_body().open("sigma7,turn=30,sway=yes,seconds=2,loop=yes");
    const std::int64_t before = support::allocation_count();
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < 2000; ++i) {
        sum += device->read(i / 1000.0).orientation.col(0);
        device->write({Vec3(0.1, 0, 0), Vec3(0, 5, 1)}, i / 1000.0);
    }
    EXPECT_EQ(support::allocation_count(), before);
    EXPECT_TRUE(sum.allFinite());
}

TEST(SimulatedTurns, options_without_meaning_are_refused) {
    const auto refusal = [](const std::string& options) {
        return support::message_of<std::invalid_argument>([&] { turning_body().open(options); });
    };
    EXPECT_TRUE(support::contains(refusal("omega3,turn=10"), "measures no orientation"));
    EXPECT_TRUE(support::contains(refusal("sigma7,turn=200"), "from -170 to 170"));
    EXPECT_TRUE(support::contains(refusal("sigma7,turn_axis=w"), "x, y, z"));
}

// The loop.

/// Peak to peak [rad] over the last second of 4 s and the one before, with the handle turned by 20
/// degrees against a spring that holds it straight, and how far the spring lets it.
struct HeldStraight {
    double movement = 0, before = 0, turn = 0;
};
HeldStraight hold_straight(const std::string& options, double part_of_bound, double rate) {
    const auto device = turning_body().open(
        options + ",grip=light,turn=20,turn_time=0.5,hand=hold,depth=0,seconds=4", rate);
    const DeviceLimits limits = device->info().limits;
    DeviceLimits raised = limits;
    raised.physical_rotational_damping = 1e6;
    ForceSettings settings;
    settings.rotational_stiffness =
        (1 - 1e-12) * limits.physical_rotational_damping / (0.5 / limits.rate + limits.delay);
    EXPECT_NO_THROW(check(settings, limits));
    settings.rotational_stiffness *= 1.001;
    EXPECT_THROW(check(settings, limits), std::invalid_argument);
    settings.rotational_stiffness *= part_of_bound / 1.001;
    ForceState state;
    HeldStraight held;
    Range range, before;
    for (int i = 0; i < static_cast<int>(4 * rate); ++i) {
        const double time = i / rate;
        const DeviceReading reading = device->read(time);
        ForceInput input;
        input.time = time;
        input.constrained = true;
        input.rotational_stiffness = settings.rotational_stiffness;
        input.orientation = Quaternion(reading.orientation);
        input.turn = rotation_between(input.orientation, straight);
        const ForceResult result = render_force(state, settings, raised, input);
        device->write({result.force, result.torque}, time);
        if (time >= 2) (time < 3 ? before : range).add(turn_of(reading));
        held.turn = turn_of(reading).norm();
    }
    held.movement = range.greatest();
    held.before = before.greatest();
    return held;
}

TEST(ClosedLoopOfRotation, comes_to_rest_at_the_bound_of_check_and_shakes_just_beyond) {
    const std::string ideal = ",delay=0,friction=no,angle_step=0,torque_step=0";
    for (const std::string name : {"sigma7", "premium6dof"}) {
        for (const double rate : {500.0, 1000.0, 2000.0}) {
            SCOPED_TRACE(name + " at " + std::to_string(rate));
            const HeldStraight at = hold_straight(name + ideal, 1, rate);
            EXPECT_LT(at.movement, 0.97 * at.before);  // dies away, slowly
            EXPECT_LE(hold_straight(name + ideal, 0.9, rate).movement, 0.01 * degree);
            EXPECT_GT(at.turn, 0.1 * degree);
            EXPECT_GT(hold_straight(name + ideal, 1.25, rate).movement, 0.5 * degree);
        }
    }
}

TEST(ClosedLoopOfRotation, a_delay_takes_its_share_of_the_bound) {
    for (const std::string name : {"sigma7", "premium6dof"}) {
        SCOPED_TRACE(name);
        // A delay d takes as much as d more of half a period: k (T / 2 + d) <= damping.
        EXPECT_EQ(turning_body().open(name)->info().limits.delay, profile(name).delay);
        EXPECT_GT(profile(name).delay, 0);
        const double step = std::max(0.01 * degree, profile(name).angle_step);
        const std::string delayed = name + ",friction=no";
        EXPECT_LE(hold_straight(delayed, 0.9, 1000).movement, 2.01 * step);
        EXPECT_GT(hold_straight(delayed, 1.25, 1000).movement, 10 * step);
        EXPECT_EQ(hold_straight(name, 1.25, 1000).movement, 0);  // friction stills it
    }
}

}  // namespace
}  // namespace palpate::devices
