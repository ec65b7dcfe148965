// Force: warm motors lower the limit, and a delay the greatest stiffness.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "palpate/force.hpp"
#include "support/constants.hpp"
#include "support/random.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr DeviceLimits touch{.maximum_force = 3.3, .continuous_force = 0.88, .warming_time = 60};

ForceSettings with_stiffness(double stiffness) {
    ForceSettings settings;
    settings.stiffness = stiffness;
    return settings;
}

/// A hand that presses with a pull of its own each tick.
struct PressingHand {
    DeviceLimits limits = touch;
    ForceSettings settings = with_stiffness(1);
    ForceState state{};
    double time = 0;

    ForceResult press(double pull, bool enabled = true) {
        ForceInput input;
        input.time = time += period;
        input.enabled = enabled;
        input.constrained = true;
        input.pull = Vec3(0, 0, pull);
        return render_force(state, settings, limits, input);
    }
    ForceResult press_for(double seconds, double pull, bool enabled = true) {
        ForceResult last;
        for (double t = 0; t < seconds; t += period) last = press(pull, enabled);
        return last;
    }
};

TEST(MotorHeat, follows_the_square_of_the_force_with_its_time_constant) {
    for (const double force : {0.5, 0.88, 3.3}) {
        MotorHeat heat{.force = force};
        const double power = std::pow(force / touch.continuous_force, 2);
        for (int i = 1; i <= 120'000; ++i) {
            heat = warmed(heat, touch, i * period, 0.02);
            if (i % 10'000 != 0) continue;
            ASSERT_NEAR(heat.warmth, power * (1 - std::exp(-i * period / 60)), 1e-4 * power);
        }
        heat.force = 0;
        const double warmth = heat.warmth;
        for (int i = 1; i <= 60'000; ++i) heat = warmed(heat, touch, 120 + i * period, 0.02);
        EXPECT_NEAR(heat.warmth, warmth * std::exp(-1), 1e-4 * warmth);
    }
}

TEST(MotorHeat, counts_a_force_for_no_longer_than_a_device_holds_it) {
    const MotorHeat pressed{.warmth = 0.5, .time = 1, .force = 3.3};
    const MotorHeat soon = warmed(pressed, touch, 1.02, 0.02);
    EXPECT_GT(soon.warmth, 0.5);
    EXPECT_LT(warmed(pressed, touch, 3600, 0.02).warmth, 0.02);
    EXPECT_EQ(warmed(pressed, touch, not_a_number, 0.02).warmth, 0.5);
    EXPECT_EQ(warmed(pressed, touch, infinity, 0.02).warmth, 0.5);
    EXPECT_EQ(warmed(pressed, touch, 0.5, 0.02).warmth, 0.5);  // a time that went back
}

TEST(MotorHeat, a_force_that_is_held_falls_to_what_the_motors_can_give_for_hours) {
    PressingHand hand;
    const ForceResult begun = hand.press_for(2, 5);
    EXPECT_NEAR(begun.force.norm(), 3.3, 1e-9);
    EXPECT_FALSE(begun.flags & force_warm);
    double last = begun.force.norm();
    for (int i = 0; i < 600'000; ++i) {
        const ForceResult now = hand.press(5);
        ASSERT_LE(now.force.norm(), last + 1e-12) << i;
        ASSERT_LE(hand.state.motors.warmth, 1) << i;
        last = now.force.norm();
        ASSERT_EQ(bool(now.flags & force_warm), last < 3.3 - 1e-9) << i;
    }
    EXPECT_NEAR(last, 0.88, 0.01);
    EXPECT_GE(last, 0.88 - 1e-9);
    // The force that the motors can give for hours remains, and a light touch is not cut.
    const ForceResult light = hand.press_for(60, 0.5);
    EXPECT_NEAR(light.force.norm(), 0.5, 1e-9);
    EXPECT_FALSE(light.flags & force_warm);
    EXPECT_NEAR(hand.press_for(0.5, 5).force.norm(), 3.3, 1e-9);  // has cooled meanwhile
}

TEST(MotorHeat, never_exceeds_that_of_the_continuous_force_whatever_is_asked) {
    Random random(41);
    int hot = 0;
    for (int session = 0; session < 200; ++session) {
        PressingHand hand;
        hand.limits.maximum_force = random.uniform(1, 20);
        hand.limits.continuous_force = hand.limits.maximum_force * random.uniform(0.05, 1.2);
        hand.limits.warming_time = random.uniform(5, 100);
        hand.settings.limit = random.chance(0.5) ? infinity : random.uniform(0.5, 20);
        MotorHeat unguarded;
        for (int i = 0; i < scaled(5000); ++i) {
            hand.time += random.chance(0.01) ? random.uniform(0, 0.1) : 0;
            const ForceResult r = hand.press(random.chance(0.9) ? 30 : 0, !random.chance(0.001));
            ASSERT_LE(hand.state.motors.warmth, 1);
            ASSERT_LE(r.force.norm(), hand.limits.maximum_force * (1 + 1e-12));
            unguarded = warmed(unguarded, hand.limits, hand.time, 0.02);
            unguarded.force = std::min(hand.limits.maximum_force, hand.settings.limit);
        }
        hot += unguarded.warmth > 1;
    }
    EXPECT_GT(hot, 20);
}

TEST(MotorHeat, outlasts_every_stop_and_goes_while_there_is_no_force) {
    PressingHand hand;
    hand.press_for(120, 5);
    const double warmth = hand.state.motors.warmth;
    EXPECT_GT(warmth, 0.9);
    hand.press(5, false);
    EXPECT_NEAR(hand.state.motors.warmth, warmth, 1e-3);
    EXPECT_LT(hand.press_for(1, 5).force.norm(), 1.5);
    restart(hand.state);
    EXPECT_LT(hand.press_for(1, 5).force.norm(), 1.5);
    hand.press_for(120, 5, false);
    EXPECT_LT(hand.state.motors.warmth, 0.2);
    EXPECT_NEAR(hand.press_for(1, 5).force.norm(), 3.3, 1e-9);
}

TEST(MotorHeat, lets_the_limit_rise_no_faster_than_the_ramp) {
    Random random(42);
    for (int i = 0; i < 100; ++i) {
        DeviceLimits limits = touch;
        limits.maximum_force = random.uniform(1, 20);
        limits.continuous_force = limits.maximum_force * random.uniform(0.02, 1);
        limits.warming_time = random.uniform(5, 100);
        MotorHeat heat{.warmth = 1};
        double last = warm_limit(limits, heat);
        EXPECT_DOUBLE_EQ(last, limits.continuous_force);
        const double most = limits.maximum_force * period / ForceSettings{}.ramp;
        for (int k = 1; k < 40'000; ++k) {
            heat = warmed(heat, limits, k * period, 0.02);
            ASSERT_LE(warm_limit(limits, heat) - last, most);
            last = warm_limit(limits, heat);
        }
        EXPECT_GT(last, limits.continuous_force * (limits.continuous_force < 0.9 * last ? 1.1 : 0));
    }
}

TEST(MotorHeat, of_a_device_that_can_give_all_its_force_for_hours_limits_nothing) {
    for (const double continuous : {infinity, 3.3}) {
        PressingHand hand;
        hand.limits.continuous_force = continuous;
        EXPECT_EQ(hand.press_for(600, 5).force, Vec3(0, 0, 3.3));
    }
}

// The delay.

/// [N s/mm] The damping with which a sampled spring and damper are passive, by the condition of
/// Colgate and Schenkel for each frequency, with the delay in the transfer function.
double needed_damping(double stiffness, double damping, double rate, double delay) {
    using Complex = std::complex<double>;
    double most = 0;
    for (int i = 1; i <= 2000; ++i) {
        const double theta = std::numbers::pi * i / 2000;
        const Complex back = std::exp(Complex(0, -theta));  // 1 / z
        const Complex wall = (stiffness + damping * rate * (1. - back)) *
                             std::exp(Complex(0, -theta * delay * rate));
        const double energy = std::real((1. - back) * wall) / (1 - std::cos(theta));
        most = std::max(most, energy / (2 * rate));
    }
    return most;
}

TEST(Delay, leaves_only_stiffnesses_that_are_passive_with_it) {
    Random random(43);
    for (int i = 0; i < 300; ++i) {
        DeviceLimits limits;
        limits.rate = random.uniform(250, 4000);
        limits.physical_damping = random.uniform(1e-3, 1e-2);
        limits.delay = random.chance(0.2) ? 0 : random.uniform(0, 5e-3);
        const double damping =
            random.chance(0.5) ? 0 : limits.physical_damping * random.uniform(0, 1);
        const double most = greatest_stiffness(limits, damping);
        const double needed = needed_damping(most, damping, limits.rate, limits.delay);
        ASSERT_LE(needed, limits.physical_damping * (1 + 1e-9)) << i;
        if (damping == 0) {  // then the bound is the best one
            ASSERT_GE(needed, 0.999 * limits.physical_damping) << i;
        }
    }
}

TEST(Delay, is_named_where_it_refuses_a_stiffness_and_the_longer_one_counts) {
    DeviceLimits limits;
    limits.delay = 2e-3;
    EXPECT_DOUBLE_EQ(greatest_stiffness(limits, 0), 1);
    const ForceSettings stiff = with_stiffness(2);
    try {
        check(stiff, limits);
        ADD_FAILURE() << "accepted";
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(),
                     "stiffness [N/mm] = 2: must be at most 1 at 1000 Hz and a delay of 2 ms to be "
                     "rendered stably");
    }
    EXPECT_NEAR(stable(stiff, limits).stiffness, 1, 1e-6);
    EXPECT_NO_THROW(check(stable(stiff, limits), limits));
    EXPECT_EQ(smaller(limits, DeviceLimits{}).delay, 2e-3);
    EXPECT_EQ(smaller(DeviceLimits{}, limits).delay, 2e-3);
    limits.delay = not_a_number;
    EXPECT_EQ(greatest_stiffness(smaller(limits, DeviceLimits{}), 0), 0);
}

}  // namespace
