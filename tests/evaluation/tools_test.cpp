// tools in its quick mode, and its judge.
#include "evaluation/claims.hpp"
#include "evaluation/tools/judge.hpp"
#include "evaluation/tools/scenes.hpp"
#include "palpate/density.hpp"

namespace palpate::evaluation {
namespace {

TEST(ToolsExperiment, claims_hold_in_quick_mode) {
    const Result result = quick_result(tools);
    EXPECT_EQ(result.claims.size(), 5U);
    EXPECT_EQ(result.figures.size(), 2U);
    // Three scenes, five tools, two methods.
    EXPECT_EQ(result.table.where("part", "hostile").rows().size(), 30U);
    // The penalty method is worth the comparison only where it fails.
    const Table penalty =
        result.table.where("method", "penalty").where("scene", "shell").where("tool", "scalpel");
    EXPECT_GT(penalty.number(0, "deepest_voxel"), 1);
}

TEST(ToolsExperiment, has_no_use_for_volumes) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("sphere:24x24x24"));
    EXPECT_THROW((void)tools(options), std::invalid_argument);
}

TEST(ToolsExperiment, stops_where_progress_throws) {
    struct Stop {};
    Options options = quick_options();
    options.progress = [](double) { throw Stop(); };
    EXPECT_THROW((void)tools(options), Stop);
}

TEST(ToolsJudge, sees_the_greatest_excess_on_a_chord) {
    const ToolScene ball = round_scene();
    // Across the ball, 3 mm from the middle: there the density is greatest.
    const double most =
        greatest_on_chord(ball.field, ball.isovalue, Vec3(-15, 3, 0), Vec3(14, 3, 0));
    const double middle =
        (value_at(ball.field, Vec3(0, 3, 0)) - ball.isovalue) / ball.field.range();
    EXPECT_NEAR(most, middle, 1e-6);
    EXPECT_LT(greatest_on_chord(ball.field, ball.isovalue, Vec3(-15, 14, 0), Vec3(14, 14, 0)), 0);
}

TEST(ToolsJudge, notices_a_tool_that_is_in_the_solid) {
    const ToolScene plane = plane_scene();
    ToolProxy proxy(tool_of(100));
    ToolVerdict verdict;
    judged_update(proxy, plane.field, {Vec3(0, 0, 10)}, verdict);
    EXPECT_EQ(verdict.chords, 0);
    judged_update(proxy, plane.field, {Vec3(0, 0, 5)}, verdict);
    EXPECT_GT(verdict.chords, 0);
    EXPECT_LT(verdict.worst_excess, 0);
    // By hand, as no update leads: the next one's chords begin there.
    proxy.pose.position[2] = -0.5;
    judged_update(proxy, plane.field, {Vec3(0, 0, 6)}, verdict);
    EXPECT_GT(verdict.worst_excess, granted);
}

}  // namespace
}  // namespace palpate::evaluation
