// Penetrability: properties of every tick for random hands, and settings that are refused.
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/scenes/volumes.hpp"
#include "support/constants.hpp"
#include "support/hand.hpp"
#include "support/press.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr int ticks = scaled(100000);

/// How often a run met what it is about.
struct Met {
    int constrained = 0, presses = 0, gaps = 0, followed_out = 0;
};

bool allowed(const Penetrability& p, double level) {
    for (int i = 0; i < p.range_count; ++i) {
        if (level >= p.ranges[i].low && level <= p.ranges[i].high) return true;
    }
    return false;
}

/// Renders one tick and checks it: G1 on the path before the press, G1 and G2 for the level felt at
/// the end.
void check_tick(Press& press, const Vec3& hip, double threshold, Met& met) {
    const Field& field = press.field;
    const double level_before = press.proxy.isovalue;
    const ProxyUpdate update = press.to(hip);
    const auto excess = [&](const Vec3& p, double level) {
        return field.sign() * (value_at(field, p) - level) / field.range();
    };
    ASSERT_EQ(update.status, UpdateStatus::done);
    ASSERT_TRUE(update.scp.allFinite() && std::isfinite(update.density));
    ASSERT_FALSE(std::isnan(update.isovalue));
    ASSERT_EQ(update.isovalue, press.proxy.isovalue);
    ASSERT_EQ(update.mode, press.proxy.mode);
    ASSERT_EQ(update.scp, press.proxy.scp_physical);
    bool pressed = false;
    for (const Step& step : press.path) {
        pressed |= step.kind == StepKind::press;
        if (step.kind == StepKind::press || step.kind == StepKind::place ||
            step.kind == StepKind::recover || step.kind == StepKind::goal) {
            continue;
        }
        ASSERT_LE(excess(step.point, level_before), 1e-9) << "G1 before the surface gave way";
    }
    ASSERT_LE(excess(update.scp, update.isovalue), 1e-9) << "G1 for the level felt";
    ASSERT_LE(pull_of(update) * press.device_per_volume, threshold * (1 + 1e-12));
    if (update.mode == Mode::constrained) {
        ASSERT_LE(std::abs(excess(update.scp, update.isovalue)), 1e-9) << "G2 for the level felt";
        ASSERT_TRUE(allowed(press.penetrability, update.isovalue)) << update.isovalue;
    } else if (!pressed) {
        ASSERT_EQ(update.scp, update.hip);
    }
    met.constrained += update.mode == Mode::constrained;
    met.presses += pressed;
    met.gaps += update.mode == Mode::free && update.isovalue != press.penetrability.ranges[0].low;
    met.followed_out += update.mode == Mode::constrained && !pressed &&
                        field.sign() * update.isovalue < field.sign() * level_before;
}

Met run(const Field& field, const Penetrability& p, std::uint64_t seed, double scale = 1) {
    Press press(field, p.ranges[0].low, p);
    press.device_per_volume = 1 / scale;
    Hand hand(field.geometry(), seed);
    Met met;
    press.to(hand.next());
    for (int i = 0; i < ticks; ++i) {
        SCOPED_TRACE("seed " + std::to_string(seed) + " tick " + std::to_string(i));
        check_tick(press, hand.next(), p.threshold, met);
        if (testing::Test::HasFatalFailure()) break;
    }
    EXPECT_GT(met.constrained, ticks / 20);
    EXPECT_GT(met.presses, ticks / 100);
    EXPECT_GT(met.followed_out, ticks / 1000);
    return met;
}

void expect_not_valid(const char* part, auto&& make) {
    try {
        make();
        ADD_FAILURE() << "accepted: " << part;
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
}

}  // namespace

TEST(Penetrability, keeps_g1_g2_and_the_threshold_in_a_head) {
    const scenes::Scene head = scenes::make_volume("shepp-logan:48x48x48");
    run(linear_field(head.volume), penetrability_threshold(1, -300), 21);
}

TEST(Penetrability, keeps_g1_g2_and_the_threshold_in_a_head_felt_by_ranges) {
    const scenes::Scene head = scenes::make_volume("shepp-logan:48x48x48");
    const std::array<DensityRange, 3> ranges{{{-200, 30}, {45, 70}, {500, 800}}};
    const Met met = run(linear_field(head.volume), penetrability_ranges(0.7, ranges), 22, 1.7);
    EXPECT_GT(met.gaps, ticks / 1000);
}

TEST(Penetrability, keeps_g1_g2_and_the_threshold_on_noise) {
    const std::array<DensityRange, 3> ranges{{{60, 90}, {128, 128}, {150, 200}}};
    const Met met = run(noise_field().field, penetrability_ranges(0.4, ranges), 23);
    EXPECT_GT(met.gaps, ticks / 1000);
}

TEST(Penetrability, keeps_g1_g2_and_the_threshold_on_an_oblique_anisotropic_grid) {
    run(oblique_field().field, penetrability_threshold(0.3, 20000), 24, 0.5);
    run(anisotropic_field().field, penetrability_threshold(0.3, 0), 25, 3);
}

TEST(Penetrability, dark_bodies_on_bright_feel_as_bright_ones_on_dark) {
    const auto sample = [](Random& random) { return random.below(3000); };
    Random first(31);
    Random second(31);
    const Geometry geometry = grid(cube(20));
    const Field bright = linear_field(
        volume_of<std::int16_t>(geometry, [&](const Index3&) { return sample(first); }));
    const Field dark = linear_field(
        volume_of<std::int16_t>(geometry, [&](const Index3&) { return -sample(second); }),
        Solid::below);
    const std::array<DensityRange, 2> ranges{{{1000, 1500}, {1800, 2500}}};
    const std::array<DensityRange, 2> mirrored{{{-1500, -1000}, {-2500, -1800}}};
    Press above(bright, 1000, penetrability_ranges(0.4, ranges));
    Press below(dark, -1000, penetrability_ranges(0.4, mirrored, Solid::below));
    Hand hand(geometry, 32);
    int constrained = 0;
    for (int i = 0; i < ticks / 4; ++i) {
        const Vec3 hip = hand.next();
        const ProxyUpdate a = above.to(hip);
        const ProxyUpdate b = below.to(hip);
        ASSERT_EQ(a.scp, b.scp) << i;
        ASSERT_EQ(a.isovalue, -b.isovalue) << i;
        ASSERT_EQ(a.mode, b.mode) << i;
        constrained += a.mode == Mode::constrained;
    }
    EXPECT_GT(constrained, ticks / 80);
}

TEST(Penetrability, a_minimum_for_dark_bodies_is_a_maximum) {
    Press press(ramp_field(Solid::below), -30, penetrability_threshold(2, -10, Solid::below));
    for (double z = -5; z < 60; z += 0.05) {
        const ProxyUpdate update = press.to(at_depth(z));
        ASSERT_NEAR(update.isovalue, -std::max(10.0, z - 2), 1e-9) << z;
    }
}

TEST(Penetrability, ranges_are_sorted_and_merged_in_the_order_the_hand_meets_them) {
    const std::array<DensityRange, 6> ranges{
        {{40, 60}, {10, 15}, {45, 50}, {12, 20}, {13, 14}, {20, 25}}};
    const Penetrability above = penetrability_ranges(1, ranges);
    ASSERT_EQ(above.range_count, 2);
    EXPECT_TRUE(above.on);
    EXPECT_EQ(above.ranges[0].low, 10);
    EXPECT_EQ(above.ranges[0].high, 25);
    EXPECT_EQ(above.ranges[1].low, 40);
    EXPECT_EQ(above.ranges[1].high, 60);
    const Penetrability below = penetrability_ranges(1, ranges, Solid::below);
    ASSERT_EQ(below.range_count, 2);
    EXPECT_EQ(below.ranges[0].high, 60);
    EXPECT_EQ(below.ranges[1].low, 10);
    EXPECT_NO_THROW(check(above, Solid::above));
    EXPECT_NO_THROW(check(below, Solid::below));
}

TEST(Penetrability, ranges_that_make_no_sense_are_refused_with_the_reason) {
    const double nan = std::nan("");
    const auto ranges = [](double low, double high) {
        return [=] { penetrability_ranges(1, std::array{DensityRange{low, high}}); };
    };
    expect_not_valid("low <= high", ranges(5, 4));
    expect_not_valid("low <= high", ranges(nan, 4));
    expect_not_valid("low <= high", ranges(4, nan));
    expect_not_valid("no range", [] { penetrability_ranges(1, {}); });
    expect_not_valid("threshold", [] { penetrability_threshold(-1, 0); });
    expect_not_valid("threshold", [&] { penetrability_threshold(nan, 0); });
    expect_not_valid("low <= high", [&] { penetrability_threshold(1, nan); });
    std::vector<DensityRange> many;
    for (int i = 0; i < 17; ++i) many.push_back({i + 0.0, i + 0.5});
    expect_not_valid("16", [&] { penetrability_ranges(1, many); });
    many.pop_back();
    EXPECT_EQ(penetrability_ranges(1, many).range_count, 16);
    many.push_back({0.2, 0.7});  // seventeen, but one overlaps
    EXPECT_EQ(penetrability_ranges(infinity, many).range_count, 16);
}

TEST(Penetrability, settings_made_by_hand_are_checked) {
    const std::array<DensityRange, 2> ranges{{{10, 20}, {40, 50}}};
    const Penetrability good = penetrability_ranges(1, ranges);
    expect_not_valid("order", [&] { check(good, Solid::below); });
    Penetrability p = good;
    p.range_count = 17;
    expect_not_valid("16", [&] { check(p, Solid::above); });
    p.range_count = 0;
    expect_not_valid("16", [&] { check(p, Solid::above); });
    p = good;
    p.ranges[1].low = 15;
    expect_not_valid("overlap", [&] { check(p, Solid::above); });
    p.ranges[1].low = std::nan("");
    expect_not_valid("low <= high", [&] { check(p, Solid::above); });
    p = good;
    p.threshold = -1;
    expect_not_valid("threshold", [&] { check(p, Solid::above); });
    p.on = false;
    EXPECT_NO_THROW(check(p, Solid::above));
}
