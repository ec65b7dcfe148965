// penetration in its quick mode, and the pressing hand.
#include <algorithm>

#include "evaluation/claims.hpp"
#include "evaluation/penetration/pressing.hpp"
#include "support/png.hpp"

namespace palpate::evaluation {
namespace {

TEST(Penetration, claims_hold_in_quick_mode_and_there_is_a_picture) {
    const Result result = quick_result(penetration);
    EXPECT_EQ(result.claims.size(), 6U);
    ASSERT_EQ(result.pictures.size(), 1U);
    const auto png = support::png_from(result.pictures[0].png);
    EXPECT_EQ(png.width, 200U);
    EXPECT_EQ(png.height, 160U);
    EXPECT_GT(png.colours(), 1000U);
    EXPECT_GT(png.count(support::is_vermilion), 10U);
}

TEST(Penetration, where_it_cannot_be_drawn_there_is_a_note_and_all_else) {
    ::setenv("PALPATE_PICTURE_HELPER", "/bin/false", 1);
    Options options = quick_options();
    std::string notes;
    options.note = [&](const std::string& note) { notes += note + "\n"; };
    const Result result = penetration(options);
    ::unsetenv("PALPATE_PICTURE_HELPER");
    EXPECT_TRUE(all_hold(result));
    EXPECT_TRUE(result.pictures.empty());
    EXPECT_NE(notes.find("without the picture of shepp-logan"), std::string::npos) << notes;
    EXPECT_EQ(std::ranges::count(notes, '\n'), 1);
}

TEST(Penetration, a_volume_of_the_user_takes_the_place_of_its_own) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("sphere:24x24x24"));
    options.subjects.push_back(synthetic("torus:32x32x16"));
    const Result result = penetration(options);
    EXPECT_TRUE(all_hold(result));
    EXPECT_EQ(result.table.text(0, "volume"), "sphere");
    EXPECT_EQ(result.table.text(result.table.rows().size() - 1, "volume"), "torus");
}

TEST(Penetration, a_level_that_no_line_meets_is_refused) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("sphere:16x16x16", 1000.0));
    EXPECT_THROW((void)penetration(options), std::invalid_argument);
}

TEST(Penetration, stops_where_progress_throws) {
    struct Stop {};
    Options options = quick_options();
    options.progress = [](double done) {
        if (done >= 0) throw Stop();
    };
    EXPECT_THROW((void)penetration(options), Stop);
}

PressingLine pressed_ball() {
    return pressing_lines({synthetic("sphere:32x32x32")}, {}, true, {}).front();
}

TEST(Pressing, goes_in_and_comes_out_along_one_line) {
    const PressingLine line = pressed_ball();
    const auto ticks = press(line, no_penetrability(), {});
    const auto turn = std::ranges::find_if(ticks, [](const auto& t) { return !t.inwards; });
    ASSERT_NE(turn, ticks.end());
    EXPECT_NEAR((turn - 1)->depth, line.depth, 0.05);
    EXPECT_EQ(ticks.front().depth, ticks.back().depth);
    EXPECT_EQ(ticks.front().update.hip, ticks.back().update.hip);
    EXPECT_LT(ticks.front().depth, -1);
    for (const PressingTick& tick : ticks) {
        const Vec3 from_entry = tick.update.hip - line.entry;
        EXPECT_LT((from_entry - tick.depth * line.inward).norm(), 1e-9);
        // The first surface is at depth 0.
        EXPECT_EQ(tick.density_at_hand > line.subject.isovalue + 1e-6, tick.depth > 1e-3)
            << tick.depth;
    }
}

TEST(Pressing, off_is_held_by_a_spring_as_long_as_the_hand_is_deep) {
    const PressingLine line = pressed_ball();
    const PressingPlan plan;
    for (const PressingTick& tick : press(line, no_penetrability(), plan)) {
        if (tick.depth < 0.1) continue;
        // A ball pressed towards its middle: the SCP stays where the hand came in.
        EXPECT_NEAR(tick.pull, tick.depth, 0.05);
        EXPECT_EQ(tick.force, plan.stiffness * tick.pull);
    }
}

TEST(Pressing, a_threshold_lets_the_hand_through_and_the_level_follows_it) {
    const PressingLine line = pressed_ball();
    const PressingPlan plan;
    const auto ticks =
        press(line, penetrability_threshold(plan.threshold, line.subject.isovalue), plan);
    double highest = 0, longest = 0;
    bool beyond = false;
    for (const PressingTick& tick : ticks) {
        highest = std::max(highest, tick.update.isovalue);
        longest = std::max(longest, tick.pull);
        beyond = beyond || (tick.depth > 5 && tick.pull <= plan.threshold);
    }
    EXPECT_GT(highest, line.subject.isovalue + 50);
    EXPECT_LE(longest, plan.threshold + 1e-9);
    EXPECT_TRUE(beyond);
    EXPECT_EQ(ticks.back().update.mode, Mode::free);
}

}  // namespace
}  // namespace palpate::evaluation
