// Force: what each effect adds to Eq. 4, one at a time. The limits are in force_limits_test.cpp.
#include "palpate/force.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/constants.hpp"
#include "support/random.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// No ramp, no rate limit, no practical maximum: the bare effects.
ForceSettings bare(double stiffness = 0.5) {
    ForceSettings settings;
    settings.stiffness = stiffness;
    settings.limit = 1e6;
    settings.rate_limit = infinity;
    settings.ramp = 0;
    return settings;
}

DeviceLimits strong() {
    DeviceLimits limits;
    limits.maximum_force = 1e6;
    return limits;
}

ForceInput contact(double time, const Vec3& pull, const Vec3& hand = Vec3::Zero()) {
    ForceInput input;
    input.time = time;
    input.constrained = true;
    input.pull = pull;
    input.hand = hand;
    return input;
}

/// The force after the hand has moved with `velocity` long enough for the filter to settle.
Vec3 settled(const ForceSettings& settings, ForceInput input, const Vec3& velocity) {
    ForceState state;
    ForceResult result;
    for (int i = 0; i < 200; ++i) {
        input.time = i * period;
        input.hand = velocity * input.time;
        result = render_force(state, settings, strong(), input);
    }
    EXPECT_EQ(result.flags, 0);
    return result.force;
}

}  // namespace

TEST(Force, is_equation_4_exactly_when_all_effects_are_neutral) {
    Random random(1);
    ForceState state;
    for (int i = 0; i < 1000; ++i) {
        const ForceSettings settings = bare(random.uniform(0, 5));
        const Vec3 pull = random.point(-3, 3);
        const Vec3 hand = random.point(-5, 5);
        const ForceResult result =
            render_force(state, settings, strong(), contact(i * period, pull, hand));
        ASSERT_EQ(result.force, settings.stiffness * pull);
        ASSERT_EQ(result.flags, 0);
    }
}

TEST(Force, is_zero_in_free_space_when_all_effects_are_neutral) {
    ForceInput input = contact(0, Vec3(1, 2, 3));
    input.constrained = false;
    input.normal = Vec3::UnitZ();
    input.surface_distance = 0.5;
    EXPECT_EQ(settled(bare(), input, Vec3(10, 20, 30)), Vec3::Zero());
}

TEST(Force, defaults_are_neutral_and_pass_their_own_check) {
    const ForceSettings settings;
    EXPECT_EQ(settings.damping, 0);
    EXPECT_EQ(settings.viscosity, 0);
    EXPECT_EQ(settings.magnet.distance, 0);
    EXPECT_EQ(settings.magnet.peak, 0);
    EXPECT_EQ(settings.texture.amplitude, 0);
    EXPECT_EQ(texture_slope(settings.texture, Vec3(0.3, 0.4, 0.5)), Vec3::Zero());
    EXPECT_NO_THROW(check(settings, DeviceLimits{}));
}

TEST(Force, damping_opposes_the_motion_along_the_contact_normal_only) {
    ForceSettings settings = bare();
    settings.damping = 0.001;
    const ForceInput input = contact(0, Vec3(0, 0, 2));
    const Vec3 in = settled(settings, input, Vec3(0, 0, -100));
    const Vec3 out = settled(settings, input, Vec3(0, 0, 100));
    const Vec3 across = settled(settings, input, Vec3(100, 0, 0));
    EXPECT_NEAR((in - Vec3(0, 0, 1.1)).norm(), 0, 1e-9);
    EXPECT_NEAR((out - Vec3(0, 0, 0.9)).norm(), 0, 1e-9);
    EXPECT_NEAR((across - Vec3(0, 0, 1)).norm(), 0, 1e-9);
}

TEST(Force, damping_never_pulls_the_hand_in_with_and_without_texture) {
    Random random(2);
    int at_zero = 0;
    for (int i = 0; i < 2000; ++i) {
        ForceSettings settings = bare();
        settings.damping = random.uniform(0, 0.01);
        ForceInput input = contact(0, random.uniform(0.01, 2) * random.direction());
        if (i % 2) input.texture_slope = random.point(-2, 2);
        const Vec3 outward = input.pull.normalized();
        ForceState state;
        render_force(state, settings, strong(), input);
        input.time = period;
        input.hand = random.point(-3, 3);
        const double push = render_force(state, settings, strong(), input).force.dot(outward);
        ASSERT_GE(push, -1e-12) << i;
        at_zero += push < 1e-12;
    }
    EXPECT_GT(at_zero, 200) << "the bound was hardly met";
}

TEST(Force, viscosity_opposes_all_motion_in_contact_or_not) {
    ForceSettings settings = bare();
    settings.viscosity = 0.002;
    const Vec3 velocity(30, -40, 50);
    ForceInput input;
    EXPECT_NEAR((settled(settings, input, velocity) + 0.002 * velocity).norm(), 0, 1e-9);
    input = contact(0, Vec3(0, 0, 2));
    EXPECT_NEAR((settled(settings, input, velocity) - Vec3(0, 0, 1) + 0.002 * velocity).norm(), 0,
                1e-9);
}

TEST(Force, viscosity_and_damping_follow_a_100_hz_low_pass) {
    ForceSettings settings = bare();
    settings.viscosity = 0.002;
    ForceState state;
    ForceInput input;
    render_force(state, settings, strong(), input);
    const double part = period / (period + 1 / (2 * std::numbers::pi * 100));
    double velocity = 0;
    for (int i = 1; i < 20; ++i) {
        input.time = i * period;
        input.hand = Vec3(0.05 * i, 0, 0);  // 50 mm/s from one tick to the next
        velocity += part * (50 - velocity);
        const Vec3 force = render_force(state, settings, strong(), input).force;
        ASSERT_NEAR(force[0], -0.002 * velocity, 1e-9);
    }
}

TEST(Force, one_false_position_is_forgotten_within_a_hundredth_of_a_second) {
    ForceSettings settings = bare();
    settings.viscosity = 0.002;
    for (const double glitch : {1e3, 1e8, 1e300}) {
        ForceState state;
        ForceInput input;
        Vec3 force = Vec3::Zero();
        for (int i = 0; i < 20; ++i) {
            input.time = i * period;
            input.hand[0] = i == 5 ? glitch : 0;
            force = render_force(state, settings, strong(), input).force;
            // 10 m/s is the fastest hand that counts.
            ASSERT_LE(force.norm(), 0.002 * 1e4);
        }
        EXPECT_LT(force.norm(), 0.1) << glitch;
    }
}

TEST(Force, magnet_is_zero_at_both_ends_and_peaks_halfway) {
    ForceSettings settings = bare();
    settings.magnet = {2, 0.8};
    ForceInput input;
    input.normal = Vec3(0, 0.6, 0.8);
    const auto at = [&](double distance) {
        input.surface_distance = distance;
        return settled(settings, input, Vec3::Zero());
    };
    EXPECT_NEAR((at(1) + 0.8 * input.normal).norm(), 0, 1e-12) << "towards the surface";
    EXPECT_NEAR(at(0.5).norm(), 0.6, 1e-12);
    EXPECT_NEAR(at(1e-9).norm(), 0, 1e-8);
    EXPECT_NEAR(at(2 - 1e-9).norm(), 0, 1e-8);
    for (const double none : {0.0, 2.0, 3.0, -1.0, std::nan(""), infinity}) {
        EXPECT_EQ(at(none), Vec3::Zero()) << none;
    }
    double last = 0;
    for (double d = 0.01; d < 1; d += 0.01) {
        const double strength = at(d).norm();
        EXPECT_GT(strength, last);
        last = strength;
    }
}

TEST(Force, magnet_lets_go_in_contact) {
    ForceSettings settings = bare();
    settings.magnet = {2, 0.8};
    ForceInput input = contact(0, Vec3(0, 0, 1));
    input.normal = Vec3::UnitZ();
    input.surface_distance = 1;
    EXPECT_EQ(settled(settings, input, Vec3::Zero()), Vec3(0, 0, 0.5));
}

TEST(Force, texture_turns_the_force_against_the_slope_and_keeps_its_strength) {
    Random random(3);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 pull = random.point(-2, 2);
        ForceInput input = contact(0, pull);
        input.texture_slope = random.point(-1, 1);
        const Vec3 force = settled(bare(), input, Vec3::Zero());
        const Vec3 outward = pull.normalized();
        const Vec3 slope = input.texture_slope - outward * outward.dot(input.texture_slope);
        ASSERT_NEAR(force.norm(), 0.5 * pull.norm(), 1e-12);
        const Vec3 lateral = force - outward * outward.dot(force);
        // Downhill: where the bump rises, the hand is pushed back.
        ASSERT_NEAR(lateral.normalized().dot(slope.normalized()), -1, 1e-9);
        ASSERT_NEAR(lateral.norm() / force.dot(outward), slope.norm(), 1e-9);
    }
}

TEST(Force, texture_across_nothing_and_without_slope_changes_nothing) {
    ForceInput input = contact(0, Vec3(0, 0, 2));
    input.texture_slope = Vec3(0, 0, 3);  // along the force: no lateral part
    EXPECT_EQ(settled(bare(), input, Vec3::Zero()), Vec3(0, 0, 1));
    input.pull = Vec3::Zero();
    input.texture_slope = Vec3(1, 1, 0);
    EXPECT_EQ(settled(bare(), input, Vec3::Zero()), Vec3::Zero());
}

TEST(Force, texture_slope_is_the_gradient_of_the_bumps) {
    const Texture texture{0.3, 1.7};
    const auto height = [&](const Vec3& p) {
        const double w = 2 * std::numbers::pi / texture.wavelength;
        return texture.amplitude / 2 *
               (std::sin(w * p[0]) + std::sin(w * p[1]) + std::sin(w * p[2]));
    };
    Random random(4);
    for (int i = 0; i < 200; ++i) {
        const Vec3 p = random.point(-20, 20);
        const Vec3 slope = texture_slope(texture, p);
        for (int a = 0; a < 3; ++a) {
            const Vec3 step = 1e-5 * Vec3::Unit(a);
            ASSERT_NEAR(slope[a], (height(p + step) - height(p - step)) / 2e-5, 1e-8);
        }
    }
}

TEST(Force, texture_has_bumps_on_every_plane) {
    const Texture texture{0.2, 2};
    const double steepest = texture.amplitude / 2 * 2 * std::numbers::pi / texture.wavelength;
    for (const double place : {0.0, 0.25, 0.5, 1.0, 3.0, 20.3}) {
        for (int across = 0; across < 3; ++across) {
            double most = 0;
            for (double along = 0; along < texture.wavelength; along += 0.01) {
                Vec3 p = Vec3::Constant(along);
                p[across] = place;
                Vec3 slope = texture_slope(texture, p);
                slope[across] = 0;
                most = std::max(most, slope.cwiseAbs().maxCoeff());
            }
            EXPECT_NEAR(most, steepest, 1e-9) << place;
        }
    }
}

TEST(Force, a_copied_state_continues_identically) {
    ForceSettings settings;
    settings.damping = 0.0005;
    settings.viscosity = 0.0005;
    Random random(5);
    ForceState state;
    ForceState copy;
    const auto input = [](Random& r, int i) {
        ForceInput in = contact(i * period, r.point(-2, 2), r.point(-1, 1));
        in.texture_slope = r.point(-1, 1);
        return in;
    };
    for (int i = 0; i < 500; ++i) {
        if (i == 250) copy = state;
        const ForceInput in = input(random, i);
        const ForceResult a = render_force(state, settings, DeviceLimits{}, in);
        if (i < 250) continue;
        const ForceResult b = render_force(copy, settings, DeviceLimits{}, in);
        ASSERT_EQ(a.force, b.force);
        ASSERT_EQ(a.flags, b.flags);
    }
}
