// The order of layers is never skipped, whatever a hand does: judged from the outside on the worst
// fields there are.
#include <gtest/gtest.h>

#include <limits>

#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/layer_order.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

constexpr double holds = std::numeric_limits<double>::infinity();

/// Five surfaces that give way.
LayerPlan five_that_give_way() {
    return {.parts = {-0.25, -0.1, 0, 0.02, 0.2},
            .forces = {0.2, 0.5, 0.35, 0.1, 0.7},
            .stiffnesses = {0.5, 0.5, 0.5, 0.5, 0.5}};
}
/// Five of which two never do, of different stiffness and with friction.
LayerPlan five_of_which_two_hold() {
    return {.parts = {-0.2, -0.1, 0, 0.05, 0.2},
            .forces = {0.2, 0.3, holds, 0.2, holds},
            .stiffnesses = {0.4, 1.5, 0.3, 0.8, 2},
            .static_friction = 0.4};
}
/// Five within a hundredth of the range: thinner than a voxel wherever the data are not flat.
LayerPlan five_thin_ones() {
    return {.parts = {-0.005, -0.003, 0, 0.002, 0.005},
            .forces = {0.1, 0.2, 0.15, 0, 0.3},
            .stiffnesses = {0.5, 0.5, 0.5, 0.5, 0.5}};
}

LayerTally stroke(const TestField& test, const LayerPlan& plan, std::uint64_t seed, int usual) {
    LayerOrder order(test.field, planned_layers(test, plan));
    Hand hand(test.field.geometry(), seed);
    const int count = scaled_or_asked(usual);
    for (int i = 0; i < count && !testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE(test.name + " tick " + std::to_string(i));
        order.tick(hand.next());
    }
    order.print(test.name);
    return order.tally();
}

void keeps_order(const TestField& test, const LayerPlan& plan, std::uint64_t seed) {
    for (const bool cubic : {false, true}) {
        const TestField on =
            cubic ? TestField{test.name + " smooth", smooth(test.field), test.isovalue} : test;
        const int usual = cubic ? 6000 : 16000;
        const LayerTally tally = stroke(on, plan, seed + cubic, usual);
        const int seldom = scaled(usual) / 1500;
        EXPECT_GT(tally.ahead, seldom);
        EXPECT_GE(tally.behind, seldom);  // hardly ever in a short run
        EXPECT_GT(tally.punctures, seldom);
        EXPECT_GT(tally.outward, seldom / 2);
        EXPECT_GT(tally.closings, seldom);
        if (testing::Test::HasFailure()) return;
    }
}

}  // namespace

TEST(LayersOrder, is_kept_on_noise) {
    keeps_order(noise_field(), five_that_give_way(), 61);
}
TEST(LayersOrder, is_kept_on_noise_where_some_surfaces_hold) {
    keeps_order(noise_field(), five_of_which_two_hold(), 63);
}
TEST(LayersOrder, is_kept_where_layers_are_thinner_than_a_voxel) {
    keeps_order(noise_field(), five_thin_ones(), 65);
}
TEST(LayersOrder, is_kept_where_the_solid_is_below) {
    keeps_order(noise_field(7, Solid::below), five_of_which_two_hold(), 67);
}
TEST(LayersOrder, is_kept_on_salt) {
    keeps_order(salt_field(), five_that_give_way(), 69);
}
TEST(LayersOrder, is_kept_on_shells_thinner_than_a_voxel) {
    LayerPlan plan = five_that_give_way();
    plan.parts = {-0.5, -0.3, -0.15, 0, 0.15};
    keeps_order(shell_field(), plan, 71);
}
TEST(LayersOrder, is_kept_on_a_sheet_that_holds) {
    keeps_order(
        sheet_field(),
        {{-0.8, -0.6, -0.45, -0.4, 0}, {0.2, 0.3, 0.2, 0.2, holds}, {0.5, 0.5, 0.5, 0.5, 0.5}}, 73);
}
TEST(LayersOrder, is_kept_on_an_anisotropic_grid) {
    keeps_order(anisotropic_field(), five_of_which_two_hold(), 75);
}
TEST(LayersOrder, is_kept_on_an_oblique_grid) {
    keeps_order(oblique_field(), five_that_give_way(), 77);
}
TEST(LayersOrder, is_kept_where_levels_are_those_of_plateaus) {
    // A few values only: 0, 1, 2 and 3. Range 3.
    keeps_order(
        terraces_field(),
        {{-0.1, 0, 1. / 6, 1. / 3, 0.5}, {0.2, 0.3, 0.2, 0.2, 0.4}, {0.5, 0.5, 0.5, 0.5, 0.5}}, 79);
}
TEST(LayersOrder, is_kept_far_from_zero) {
    keeps_order(offset_field(), five_that_give_way(), 81);
}
