// The proxy between two levels: it comes through neither, from either side, on linear and smooth
// fields.
#include <gtest/gtest.h>

#include "support/cubic_guarantees.hpp"
#include "support/fields.hpp"
#include "support/guarantees.hpp"
#include "support/hand.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// A layer of a field: what lies this part of the range on either side of the isovalue.
Proxy in_layer(const TestField& test, double half) {
    const double thickness = half * test.field.range() * test.field.sign();
    Proxy proxy;
    proxy.isovalue = test.isovalue + thickness;
    proxy.behind = test.isovalue - thickness;
    return proxy;
}

struct SidesMet {
    int updates = 0;
    int ahead = 0, behind = 0, both = 0;  ///< both: changed in one update
};

template <class Checked>
SidesMet run_between(Checked& checked, const TestField& test, double half, std::uint64_t seed,
                     const HandStyle& style) {
    Hand hand(test.field.geometry(), seed, style);
    Proxy proxy = in_layer(test, half);
    SidesMet met;
    bool was_behind = false;
    const int count = scaled_or_asked(20000);
    for (int i = 0; i < count; ++i) {
        SCOPED_TRACE(test.name + " update " + std::to_string(i));
        ++met.updates;
        const ProxyUpdate update = checked.update(proxy, hand.next());
        if (testing::Test::HasFailure()) break;
        if (update.mode != Mode::constrained) continue;
        ++(update.behind ? met.behind : met.ahead);
        met.both += update.behind != was_behind;
        was_behind = update.behind;
        EXPECT_EQ(update.isovalue, update.behind ? *proxy.behind : proxy.isovalue);
    }
    checked.print(test.name);
    return met;
}

void expect_both_sides(const SidesMet& met) {
    EXPECT_GT(met.ahead, met.updates / 40);
    EXPECT_GT(met.behind, met.updates / 40);
    EXPECT_GT(met.both, met.updates / 200);
}

void keeps_on_linear(const TestField& test, double half, std::uint64_t seed,
                     const HandStyle& style = {}) {
    Guarantees checked(test.field, &update_exact);
    expect_both_sides(run_between(checked, test, half, seed, style));
    EXPECT_EQ(checked.tally().out_of_budget, 0);
}

void keeps_on_smooth(const TestField& test, double half, std::uint64_t seed,
                     const HandStyle& style = {}) {
    const TestField smoothed{test.name, smooth(test.field), test.isovalue};
    CubicGuarantees checked(smoothed.field);
    expect_both_sides(run_between(checked, smoothed, half, seed, style));
    EXPECT_EQ(checked.tally().out_of_budget, 0);
}

}  // namespace

TEST(ProxyInLayer, keeps_its_guarantees_on_linear_noise) {
    keeps_on_linear(noise_field(), 0.1, 31);
}
TEST(ProxyInLayer, keeps_its_guarantees_in_a_layer_thinner_than_a_voxel) {
    keeps_on_linear(noise_field(), 0.01, 32);
}
TEST(ProxyInLayer, keeps_its_guarantees_where_the_solid_is_below) {
    keeps_on_linear(noise_field(7, Solid::below), 0.1, 33);
}
TEST(ProxyInLayer, keeps_its_guarantees_on_an_oblique_linear_grid) {
    keeps_on_linear(oblique_field(), 0.1, 34);
}
TEST(ProxyInLayer, keeps_its_guarantees_on_smooth_noise) {
    keeps_on_smooth(noise_field(), 0.05, 35);
}
TEST(ProxyInLayer, keeps_its_guarantees_in_a_smooth_layer_thinner_than_a_voxel) {
    keeps_on_smooth(noise_field(), 0.005, 36);
}
TEST(ProxyInLayer, keeps_its_guarantees_on_an_oblique_smooth_grid) {
    keeps_on_smooth(oblique_field(), 0.05, 37);
}
TEST(ProxyInLayer, keeps_its_guarantees_on_anisotropic_smooth_noise_below) {
    const TestField test = anisotropic_field();
    keeps_on_smooth({test.name, linear_field(test.field.volume(), Solid::below), 1000}, 0.05, 38);
}

TEST(ProxyInLayer, stays_between_two_planes) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        Field field =
            linear_field(volume_of<float>(grid({9, 9, 40}), [](const Index3& i) { return i[2]; }));
        field.set_interpolation(interpolation);
        Proxy proxy;
        proxy.isovalue = 20;
        proxy.behind = 15;
        update_exact(proxy, field, {4, 4, 17});
        EXPECT_EQ(proxy.mode, Mode::free);
        const ProxyUpdate deep = update_exact(proxy, field, {4.25, 4, 30});
        EXPECT_EQ(deep.mode, Mode::constrained);
        EXPECT_FALSE(deep.behind);
        EXPECT_NEAR(deep.scp[2], 20, 1e-9);
        EXPECT_LT((normal_at(proxy, field) + Vec3::UnitZ()).norm(), 1e-9);
        const ProxyUpdate out = update_exact(proxy, field, {4.75, 4, 2});
        EXPECT_TRUE(out.behind);
        EXPECT_EQ(out.isovalue, 15);
        EXPECT_NEAR(out.scp[2], 15, 1e-9);
        EXPECT_NEAR(out.scp[0], 4.75, 1e-4);
        EXPECT_LT((normal_at(proxy, field) - Vec3::UnitZ()).norm(), 1e-9);
        const ProxyUpdate between = update_exact(proxy, field, {4, 4.5, 18});
        EXPECT_EQ(between.mode, Mode::free);
        EXPECT_EQ(between.scp, Vec3(4, 4.5, 18));
    }
}

TEST(ProxyInLayer, has_the_friction_of_the_surface_that_it_touches) {
    Field field =
        linear_field(volume_of<float>(grid({9, 9, 40}), [](const Index3& i) { return i[2]; }));
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        field.set_interpolation(interpolation);
        ProxySettings settings;
        settings.behind = {.static_coefficient = 0.8, .dynamic_coefficient = 0.8};
        Proxy proxy;
        proxy.isovalue = 20;
        proxy.behind = 15;
        update_exact(proxy, field, {3, 4, 17}, settings);
        update_exact(proxy, field, {3, 4, 22}, settings);
        const ProxyUpdate ahead = update_exact(proxy, field, {4, 4, 22}, settings);
        EXPECT_NEAR(ahead.scp[0], 4, 1e-3) << "slides freely ahead";
        update_exact(proxy, field, {4, 4, 13}, settings);
        const ProxyUpdate behind = update_exact(proxy, field, {5, 4, 13}, settings);
        EXPECT_NEAR(behind.scp[0], 4, 1e-9) << "sticks behind: 1 mm aside at a depth of 2";
    }
}

TEST(ProxyInLayer, comes_back_into_its_layer_when_its_levels_change) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        Field field =
            linear_field(volume_of<float>(grid({9, 9, 40}), [](const Index3& i) { return i[2]; }));
        field.set_interpolation(interpolation);
        Proxy proxy;
        proxy.isovalue = 20;
        proxy.behind = 15;
        update_exact(proxy, field, {4, 4, 16});
        proxy.behind = 17;
        const ProxyUpdate pushed = update_exact(proxy, field, {4, 4, 16});
        EXPECT_EQ(pushed.status, UpdateStatus::done);
        EXPECT_TRUE(pushed.behind);
        EXPECT_NEAR(pushed.scp[2], 17, 1e-6);
    }
}

TEST(StraightProxy, stops_at_a_surface_without_sliding) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        Field field = linear_field(
            volume_of<float>(grid({20, 9, 40}), [](const Index3& i) { return i[2] + i[0]; }));
        field.set_interpolation(interpolation);
        Proxy proxy;
        proxy.isovalue = 30;
        update_straight(proxy, field, {10, 4, 10});
        const ProxyUpdate stopped = update_straight(proxy, field, {10, 4, 30});
        EXPECT_EQ(stopped.mode, Mode::constrained);
        EXPECT_LT((stopped.scp - Vec3(10, 4, 20)).norm(), 1e-9);
        const ProxyUpdate deeper = update_straight(proxy, field, {10, 4, 35});
        EXPECT_LT((deeper.scp - stopped.scp).norm(), 1e-9);
        const ProxyUpdate back = update_straight(proxy, field, {10, 4, 15});
        EXPECT_EQ(back.scp, Vec3(10, 4, 15));
    }
}
