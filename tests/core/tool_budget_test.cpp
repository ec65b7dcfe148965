// The budget of a tool's update (T5): its work is bounded, and counts everything that takes time.
#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "palpate/tool_proxy.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"

namespace palpate {
namespace {

/// T5: whatever an update has to do, its work is bounded, and what it does not do is done later.
TEST(ToolBudget, does_no_more_work_than_its_budget_in_noise_in_the_solid_and_with_friction) {
    const Field field = support::smooth(support::noise_field().field);
    const auto tool = std::make_shared<const Tool>(box_tool({6, 6, 3}, 0.25));
    const int points = static_cast<int>(tool->points().size());
    constexpr int most_at_once = 27 * 5 + 32 * 3 + 300;  // bounds of bricks, contacts, half-spaces
    int most = 0, recovering = 0, out_of_budget = 0;
    for (const double coefficient : {0.0, 0.5}) {
        ToolProxy proxy(tool);
        ToolSettings settings{.friction = {coefficient, coefficient}, .work_budget = 300};
        support::Hand hand(field.geometry(), 5);
        for (int i = 0; i < support::scaled(600); ++i) {
            proxy.isovalue = i / 20 % 2 == 0 ? 170 : 150;
            const Quaternion turn = turned(Quaternion::Identity(), {0, 0, 0.01 * (i % 300)});
            const ToolUpdate r = update_tool(proxy, field, {hand.next(), turn}, settings);
            most = std::max(most, r.work);
            recovering += r.status == UpdateStatus::recovering;
            out_of_budget += r.status == UpdateStatus::out_of_budget;
        }
    }
    std::printf("[ evidence ] points %d  most work %d  recovering %d  out of budget %d\n", points,
                most, recovering, out_of_budget);
    EXPECT_LE(most, 300 + 2 * points + most_at_once);
    EXPECT_GT(recovering, 0);
    EXPECT_GT(out_of_budget, 0);
}

/// If a tool can hardly move, its points are examined about as far as it can go, not to the end of
/// the wanted step. That took 4.9 cubes per point and round.
TEST(ToolBudget, looks_in_noise_no_farther_than_it_can_go) {
    const Field field = support::smooth(support::noise_field().field);
    const auto tool = std::make_shared<const Tool>(box_tool({6, 6, 6}, 0.5));
    ToolProxy proxy(tool);
    proxy.isovalue = support::noise_field().isovalue;
    double work = 0, rounds = 0;
    for (int i = 0; i < 400; ++i) {
        const double t = 0.02 * i;
        const Vec3 place(12 + 5 * std::sin(t), 12 + 5 * std::sin(1.6 * t), i < 1 ? 32.0 : 18.0);
        const Quaternion turn = turned(Quaternion::Identity(), 0.004 * i * Vec3(1, 2, 3));
        const ToolUpdate r = update_tool(proxy, field, {place, turn});
        work += r.work;
        rounds += r.rounds;
    }
    EXPECT_GT(rounds, 400) << "it moves";
    EXPECT_LT(work / rounds, 3 * double(tool->points().size()));
}

TEST(ToolBudget, counts_the_samples_that_it_gathers) {
    const Volume volume = support::noise_field().field.volume();
    const auto tool = std::make_shared<const Tool>(box_tool({4, 3, 2}, 1));
    const auto run = [&](const Field& field) {
        ToolProxy proxy(tool);
        proxy.isovalue = 170;
        support::Hand hand(field.geometry(), 6);
        std::pair<double, Vec3> result{0, Vec3::Zero()};
        for (int i = 0; i < support::scaled(400); ++i) {
            const Quaternion turn = turned(Quaternion::Identity(), {0, 0, 0.01 * (i % 300)});
            const ToolUpdate r =
                update_tool(proxy, field, {hand.next(), turn}, {.work_budget = 1'000'000});
            result.first += r.work;
            result.second += r.proxy.position;
        }
        return result;
    };
    const auto plain = run(Field(volume)), gathered = run(support::between_alike(volume));
    EXPECT_EQ(plain.second, gathered.second) << "the same samples";
    EXPECT_GT(gathered.first, 1.2 * plain.first);
}

/// The chords of the points on the plane take several times the budget.
TEST(ToolBudget, lets_thousands_of_points_flat_on_a_plane_come_to_rest_and_slide) {
    const Field field = support::smooth(linear_field(support::volume_of<float>(
        support::grid(support::cube(48)), [](const Index3& i) { return 24 - i[2]; })));
    const auto tool = std::make_shared<const Tool>(box_tool({16, 16, 2}, 0.25));
    ASSERT_GT(tool->points().size(), 8000U);
    constexpr double rests_at = 15;
    for (const int budget : {200, 1000}) {
        ToolProxy proxy(tool);
        proxy.isovalue = 10;
        const ToolSettings settings{.work_budget = budget};
        const auto update = [&](double x, double z) {
            return update_tool(proxy, field, {{x, 24, z}, Quaternion::Identity()}, settings);
        };
        update(20, 20);
        ToolUpdate r;
        int ticks = 0;
        do {
            r = update(20, 14);
        } while (r.status != UpdateStatus::done && ++ticks < 200);
        ASSERT_EQ(r.status, UpdateStatus::done) << budget;
        EXPECT_EQ(r.mode, Mode::constrained);
        EXPECT_NEAR(r.proxy.position[2], rests_at, 1e-3);
        for (int i = 1; i <= 400; ++i) r = update(20 + 0.01 * i, 14);
        EXPECT_NEAR(r.proxy.position[0], 24, 0.5) << budget;
        for (ticks = 0; r.status != UpdateStatus::done && ticks < 200; ++ticks) r = update(24, 14);
        EXPECT_EQ(r.status, UpdateStatus::done) << budget;
        EXPECT_NEAR(r.proxy.position[0], 24, 1e-3) << budget;
    }
}

TEST(ToolBudget, may_be_as_large_as_an_integer) {
    const Field field = support::smooth(support::noise_field().field);
    ToolProxy proxy(std::make_shared<const Tool>(box_tool({2, 2, 2}, 0.5)));
    proxy.isovalue = 165;
    const ToolSettings settings{.work_budget = std::numeric_limits<int>::max()};
    update_tool(proxy, field, {{12, 12, 30}, Quaternion::Identity()}, settings);
    const ToolUpdate r =
        update_tool(proxy, field, {{12, 12, 27}, Quaternion::Identity()}, settings);
    EXPECT_EQ(r.status, UpdateStatus::done);
    EXPECT_EQ(r.proxy.position[2], 27);
}

/// Each update may look at every point, whatever its samples cost: otherwise a tool of many points
/// could never tell whether it is out.
TEST(ToolBudget, lets_a_tool_of_many_points_out_of_the_solid_where_samples_are_gathered) {
    const Volume slope = support::volume_of<float>(support::grid(support::cube(24)),
                                                   [](const Index3& i) { return 12 - i[2]; });
    const Field field = support::between_alike(slope);
    const auto tool = std::make_shared<const Tool>(box_tool({6, 6, 3}, 0.25));
    ASSERT_GT(tool->points().size(), 2000U);
    ToolProxy proxy(tool);
    ToolUpdate r;
    int recovering = 0;
    for (int i = 0; i < 40; ++i) {
        r = update_tool(proxy, field, {{12, 12, 11}, Quaternion::Identity()}, {.work_budget = 400});
        recovering += r.status == UpdateStatus::recovering;
    }
    EXPECT_GT(recovering, 0);
    EXPECT_NE(r.status, UpdateStatus::recovering);
    EXPECT_NEAR(r.proxy.position[2], 13.5, 1e-4);
}

}  // namespace
}  // namespace palpate
