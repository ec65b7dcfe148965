// Penetrability on a ramp, where the level felt and the depth of the hand are the same number.
#include "palpate/proxy.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/scenes/volumes.hpp"
#include "support/constants.hpp"
#include "support/press.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr double tolerance = 1e-9;

bool has_press(const Press& press) {
    for (const Step& step : press.path) {
        if (step.kind == StepKind::press) return true;
    }
    return false;
}

/// Moves the hand along the ramp in steps of at most 0.05 mm; `each` sees depth and update.
template <class Each>
void move(Press& press, double from, double to, Each&& each) {
    const int steps = static_cast<int>(std::ceil(std::abs(to - from) / 0.05));
    for (int i = 0; i <= steps; ++i) {
        const double z = from + (to - from) * i / steps;
        const ProxyUpdate update = press.to(at_depth(z));
        SCOPED_TRACE("z " + std::to_string(z));
        each(z, update);
        if (testing::Test::HasFailure()) return;
    }
}

Penetrability two_ranges(double threshold) {
    const std::array<DensityRange, 2> ranges{{{10, 20}, {40, 50}}};
    return penetrability_ranges(threshold, ranges);
}

}  // namespace

TEST(Penetrability, off_leaves_the_level_and_the_proxy_as_they_are) {
    Press press(ramp_field(), 30, no_penetrability());
    move(press, -5, 80, [&](double z, const ProxyUpdate& update) {
        EXPECT_EQ(update.isovalue, 30);
        EXPECT_NEAR(update.scp[2], std::min(z, 30.0), tolerance);
        EXPECT_FALSE(has_press(press));
    });
}

TEST(Penetrability, level_follows_the_hand_in_and_out_and_never_below_the_minimum) {
    const double pt = 2;
    const double minimum = 10;
    Press press(ramp_field(), 30, penetrability_threshold(pt, minimum));
    move(press, -5, 60, [&](double z, const ProxyUpdate& update) {
        EXPECT_NEAR(update.isovalue, std::max(minimum, z - pt), tolerance);
        EXPECT_EQ(update.mode, z < minimum ? Mode::free : Mode::constrained);
        EXPECT_NEAR(update.scp[2], z < minimum ? z : std::max(minimum, z - pt), tolerance);
    });
    const double deepest = 60 - pt;
    move(press, 60, -5, [&](double z, const ProxyUpdate& update) {
        EXPECT_NEAR(update.isovalue, std::max(minimum, std::min(deepest, z)), tolerance);
        EXPECT_EQ(update.mode, z < minimum ? Mode::free : Mode::constrained);
        EXPECT_NEAR(update.scp[2], std::min(deepest, z), tolerance);
    });
    EXPECT_EQ(press.proxy.isovalue, minimum);
}

TEST(Penetrability, a_hand_that_turns_round_inside_meets_the_level_where_it_turned) {
    const double pt = 2;
    Press press(ramp_field(), 30, penetrability_threshold(pt, 10));
    move(press, 0, 60, [](double, const ProxyUpdate&) {});
    move(press, 60, 40, [](double, const ProxyUpdate&) {});
    move(press, 40, 55, [&](double z, const ProxyUpdate& update) {
        EXPECT_NEAR(update.isovalue, std::max(40.0, z - pt), tolerance);
        EXPECT_NEAR(pull_of(update), std::min(pt, z - 40), tolerance);
    });
}

TEST(Penetrability, exactly_at_the_minimum_is_contact_without_pull) {
    Press press(ramp_field(), 10, penetrability_threshold(2, 10));
    press.to(at_depth(5));
    const ProxyUpdate at = press.to(at_depth(10));
    EXPECT_EQ(at.mode, Mode::constrained);
    EXPECT_EQ(at.isovalue, at.density);
    EXPECT_NEAR(at.isovalue, 10, tolerance);
    EXPECT_EQ(pull_of(at), 0);
    EXPECT_EQ(press.to(at_depth(9.5)).mode, Mode::free);
    EXPECT_NEAR(press.to(at_depth(11)).scp[2], 10, tolerance);
}

TEST(Penetrability, between_two_ranges_the_hand_is_free_and_contact_begins_at_the_near_end) {
    const double pt = 2;
    Press press(ramp_field(), 0, two_ranges(pt));
    move(press, -5, 60, [&](double z, const ProxyUpdate& update) {
        const bool first = z >= 10 && z - pt <= 20;
        const bool second = z >= 40 && z - pt <= 50;
        EXPECT_EQ(update.mode, first || second ? Mode::constrained : Mode::free);
        if (first || second) {
            EXPECT_NEAR(update.isovalue, std::max(first ? 10.0 : 40.0, z - pt), tolerance);
            EXPECT_NEAR(update.scp[2], update.isovalue, tolerance);
        } else {
            EXPECT_EQ(update.isovalue, z < 10 ? 10 : z < 40 ? 40 : infinity);
            if (!has_press(press)) {
                EXPECT_EQ(update.scp, update.hip);
            }
        }
    });
}

TEST(Penetrability, on_the_way_out_the_ranges_are_met_again_from_behind) {
    Press press(ramp_field(), 0, two_ranges(2));
    press.to(at_depth(-5));
    for (double z = -5; z <= 60; z += 0.05) press.to(at_depth(z));
    EXPECT_EQ(press.proxy.isovalue, infinity);
    move(press, 60, -5, [&](double z, const ProxyUpdate& update) {
        const bool inside = (z >= 10 && z <= 20) || (z >= 40 && z <= 50);
        EXPECT_EQ(update.scp, update.hip);
        EXPECT_EQ(update.mode, inside ? Mode::constrained : Mode::free);
        const double level = inside ? z : z < 10 ? 10 : z < 40 ? 40 : infinity;
        if (std::isfinite(level)) {
            EXPECT_NEAR(update.isovalue, level, tolerance);
        } else {
            EXPECT_EQ(update.isovalue, level);
        }
    });
}

TEST(Penetrability, past_the_last_range_nothing_is_a_number_gone_wrong) {
    Press press(ramp_field(), 0, two_ranges(2));
    move(press, -5, 60, [](double, const ProxyUpdate&) {});
    move(press, 60, 99, [&](double, const ProxyUpdate& update) {
        EXPECT_TRUE(update.scp.allFinite());
        EXPECT_TRUE(std::isfinite(update.density));
        EXPECT_FALSE(std::isnan(update.isovalue));
        EXPECT_EQ(update.mode, Mode::free);
        EXPECT_EQ(update.scp, update.hip);
    });
}

TEST(Penetrability, one_jump_through_all_ranges_ends_as_the_end_says) {
    Press press(ramp_field(), 0, two_ranges(2));
    press.to(at_depth(-5));
    const ProxyUpdate in = press.to(at_depth(90));
    EXPECT_EQ(in.mode, Mode::free);
    EXPECT_EQ(in.isovalue, infinity);
    EXPECT_NEAR(pull_of(in), 2, tolerance);
    EXPECT_EQ(press.to(at_depth(90)).scp, at_depth(90));
    const ProxyUpdate out = press.to(at_depth(15));
    EXPECT_EQ(out.scp, at_depth(15));
    EXPECT_EQ(out.mode, Mode::constrained);
    EXPECT_NEAR(out.isovalue, 15, tolerance);
    press.to(at_depth(90));
    press.to(at_depth(90));
    EXPECT_EQ(press.to(at_depth(-5)).isovalue, 10);
    EXPECT_EQ(press.proxy.mode, Mode::free);
}

TEST(Penetrability, threshold_zero_gives_way_at_once) {
    Press press(ramp_field(), 10, penetrability_threshold(0, 10));
    move(press, -5, 60, [&](double z, const ProxyUpdate& update) {
        EXPECT_EQ(pull_of(update), 0);
        EXPECT_NEAR(update.isovalue, std::max(10.0, z), tolerance);
    });
}

TEST(Penetrability, threshold_infinity_holds_for_ever) {
    Press press(ramp_field(), 10, penetrability_threshold(infinity, 10));
    move(press, -5, 90, [&](double z, const ProxyUpdate& update) {
        EXPECT_EQ(update.isovalue, 10);
        EXPECT_NEAR(update.scp[2], std::min(z, 10.0), tolerance);
    });
}

TEST(Penetrability, threshold_is_in_millimetres_of_the_hand) {
    // A scale of 3: a millimetre of the hand is three of the volume.
    Press press(ramp_field(), 10, penetrability_threshold(2, 10));
    press.device_per_volume = 1.0 / 3;
    move(press, -5, 60, [&](double z, const ProxyUpdate& update) {
        EXPECT_NEAR(update.isovalue, std::max(10.0, z - 6), tolerance);
        if (z > 16.1) {
            EXPECT_NEAR(pull_of(update), 6, tolerance);
        }
    });
}

TEST(Penetrability, a_function_of_ones_own_sets_the_threshold_by_density) {
    struct Rule {
        double per_level;
        mutable int calls = 0;
        mutable Pressing last{};
    } rule{0.1};
    Penetrability p = penetrability_threshold(99, 10);
    p.function = [](const Pressing& pressing, const void* context) {
        const auto& r = *static_cast<const Rule*>(context);
        ++r.calls;
        r.last = pressing;
        return r.per_level * pressing.isovalue;
    };
    p.context = &rule;
    Press press(ramp_field(), 10, p);
    press.device_per_volume = 0.5;
    press.to(at_depth(5));
    EXPECT_EQ(rule.calls, 0) << "free, yet asked";
    double level = 10;
    move(press, 11, 80, [&](double z, const ProxyUpdate& update) {
        EXPECT_EQ(rule.last.isovalue, level) << "the function sees the level felt before";
        EXPECT_NEAR(rule.last.pull, 0.5 * (z - level), tolerance);
        EXPECT_EQ(rule.last.hip, at_depth(z));
        EXPECT_NEAR(rule.last.scp[2], level, tolerance);
        // Harder with depth: 0.1 level in device mm is 0.2 level in the volume's.
        if (0.5 * (z - level) > 0.1 * level) level = z - 0.2 * level;
        EXPECT_NEAR(update.isovalue, level, tolerance);
        level = update.isovalue;
    });
    EXPECT_GT(level, 60);
}

TEST(Penetrability, a_function_that_answers_nonsense_counts_as_zero) {
    for (const double answer : {std::nan(""), -1.0, -infinity}) {
        Penetrability p = penetrability_threshold(5, 10);
        p.context = &answer;
        p.function = [](const Pressing&, const void* context) {
            return *static_cast<const double*>(context);
        };
        Press press(ramp_field(), 10, p);
        move(press, -5, 40,
             [&](double, const ProxyUpdate& update) { EXPECT_EQ(update.scp, update.hip); });
    }
}

TEST(Penetrability, switched_on_while_pressing_moves_nothing) {
    Press press(ramp_field(), 30, no_penetrability());
    move(press, 20, 31.5, [](double, const ProxyUpdate&) {});
    const Proxy before = press.proxy;
    press.penetrability = penetrability_threshold(2, 10);
    const ProxyUpdate same = press.to(at_depth(31.5));
    EXPECT_EQ(same.scp, before.scp_physical);
    EXPECT_EQ(same.isovalue, 30);
    EXPECT_EQ(same.mode, Mode::constrained);
    // A level outside the ranges is kept too, until it is pressed through or left.
    press.penetrability = two_ranges(2);
    EXPECT_EQ(press.to(at_depth(31.5)).isovalue, 30);
    EXPECT_EQ(press.to(at_depth(33)).isovalue, 40);
}

TEST(Penetrability, switched_off_while_pressing_keeps_the_level_felt) {
    Press press(ramp_field(), 10, penetrability_threshold(2, 10));
    move(press, 5, 40, [](double, const ProxyUpdate&) {});
    const Vec3 before = press.proxy.scp_physical;
    press.penetrability = no_penetrability();
    EXPECT_NEAR((press.to(at_depth(40)).scp - before).norm(), 0, tolerance);
    move(press, 40, 60, [&](double, const ProxyUpdate& update) {
        EXPECT_NEAR(update.isovalue, 38, tolerance);
        EXPECT_NEAR(update.scp[2], 38, tolerance);
    });
}

TEST(Penetrability, an_observer_sees_where_the_surface_gave_way) {
    Press press(ramp_field(), 10, penetrability_threshold(2, 10));
    int presses = 0;
    move(press, 5, 30, [&](double z, const ProxyUpdate& update) {
        EXPECT_EQ(has_press(press), z > 12 + tolerance);
        if (!has_press(press)) return;
        ++presses;
        EXPECT_EQ(press.path.back().kind, StepKind::press);
        EXPECT_EQ(press.path.back().point, update.scp);
        EXPECT_EQ(press.path.back().goal, update.hip);
    });
    EXPECT_GT(presses, 300);
}

TEST(Penetrability, updates_that_are_not_done_pass_unchanged) {
    for (const auto status :
         {UpdateStatus::out_of_budget, UpdateStatus::recovering, UpdateStatus::refused}) {
        Press press(ramp_field(), 10, penetrability_threshold(2, 10));
        press.to(at_depth(5));
        ProxyUpdate update = update_exact(press.proxy, press.field, at_depth(50));
        update.status = status;
        const Vec3 scp = update.scp;
        apply_penetrability(press.penetrability, press.field, 1, press.proxy, update);
        EXPECT_EQ(update.scp, scp);
        EXPECT_EQ(press.proxy.scp_physical, scp);
        EXPECT_EQ(update.isovalue, 10);
    }
}

TEST(Penetrability, follows_the_hand_through_round_bodies_and_out_again) {
    for (const char* name : {"sphere:64x64x64", "cylinder"}) {
        SCOPED_TRACE(name);
        const scenes::Scene scene = scenes::make_volume(name);
        const double minimum = scene.volume.minimum() + 0.2 * scene.volume.range();
        const double pt = 1.5;
        Press press(linear_field(scene.volume), scene.isovalue,
                    penetrability_threshold(pt, minimum));
        const Geometry& geometry = scene.volume.geometry();
        const double outside = geometry.spacing[0] * geometry.size[0] * 0.6;
        const Vec3 along = Vec3(1, 0.3, 0.1).normalized();
        double last = minimum;
        int pressed = 0;
        for (double way = outside; way > 0.5; way -= 0.05) {
            const ProxyUpdate update = press.to(way * along);
            ASSERT_GE(update.isovalue, last - 1e-9 * scene.volume.range());
            ASSERT_LE(pull_of(update), pt * (1 + 1e-12));
            pressed += has_press(press);
            last = update.isovalue;
        }
        EXPECT_GT(last, minimum + 0.3 * scene.volume.range());
        EXPECT_GT(pressed, 50);
        for (double way = 0.5; way < outside; way += 0.05) {
            const ProxyUpdate update = press.to(way * along);
            ASSERT_LE(update.isovalue, last + 1e-9 * scene.volume.range());
            ASSERT_GE(update.isovalue, minimum);
            last = update.isovalue;
        }
        EXPECT_EQ(last, minimum);
        EXPECT_EQ(press.proxy.mode, Mode::free);
    }
}
