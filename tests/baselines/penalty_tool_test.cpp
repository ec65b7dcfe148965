// The penalty method for tools works as published, and lets points through that it cannot hold.
#include "palpate/baselines/penalty_tool.hpp"

#include <gtest/gtest.h>

#include "support/allocation_counter.hpp"
#include "support/fields.hpp"

namespace palpate::baselines {
namespace {

/// Falls along z to 0 at 12: solid below.
Field plane_field() {
    return Field(support::volume_of<float>(support::grid(support::cube(24)),
                                           [](const Index3& i) { return 12.0 - i[2]; }));
}

TEST(PenaltyTool, is_the_hand_where_nothing_touches) {
    const Field field = plane_field();
    PenaltyTool state{std::make_shared<const Tool>(box_tool({4, 3, 2}, 1))};
    update_penalty(state, field, {Vec3(12, 12, 18)});
    const Pose hand{Vec3(10, 13, 16), turned(Quaternion::Identity(), {0.3, -0.2, 0.1})};
    const PenaltyUpdate update = update_penalty(state, field, hand);
    EXPECT_EQ(update.inside, 0);
    EXPECT_NEAR((update.proxy.position - hand.position).norm(), 0, 1e-12);
    EXPECT_NEAR(update.proxy.orientation.angularDistance(hand.orientation), 0, 1e-7);
}

TEST(PenaltyTool, rests_where_hand_and_points_are_in_equilibrium) {
    const Field field = plane_field();
    PenaltyTool state{std::make_shared<const Tool>(std::vector<Vec3>{Vec3::Zero()})};
    PenaltySettings settings;
    settings.deepest = 10;
    PenaltyUpdate update;
    for (int i = 0; i < 60; ++i) {
        update = update_penalty(state, field, {Vec3(12, 12, 11)}, settings);
    }
    // 1 mm of pull, shared by springs of 1 and 4: a depth of a fifth.
    EXPECT_EQ(update.inside, 1);
    EXPECT_NEAR(update.proxy.position[2], 11.8, 1e-6);
    EXPECT_NEAR(update.deepest, 0.2, 1e-6);
}

TEST(PenaltyTool, goes_through_a_thin_wall_that_it_is_pressed_into) {
    const Field field =
        Field(support::volume_of<float>(support::grid(support::cube(24)),
                                        [](const Index3& i) { return 1.5 - std::abs(i[2] - 12); }));
    PenaltyTool state{std::make_shared<const Tool>(rod_tool(4, 0.5)), 0.75};
    for (int i = 0; i <= 100; ++i) update_penalty(state, field, {Vec3(12, 12, 16 - 0.1 * i)});
    EXPECT_LT(state.pose.position[2], 11);
}

TEST(PenaltyTool, allocates_nothing) {
    const Field field = plane_field();
    PenaltyTool state{std::make_shared<const Tool>(box_tool({4, 3, 2}, 1))};
    update_penalty(state, field, {Vec3(12, 12, 12)});
    const auto before = support::allocation_count();
    for (int i = 0; i < 100; ++i) update_penalty(state, field, {Vec3(12, 12, 12)});
    EXPECT_EQ(support::allocation_count(), before);
}

}  // namespace
}  // namespace palpate::baselines
