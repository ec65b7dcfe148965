// performance in its quick mode, and what it uses: the exploring hand, the timing, the paper's
// table.
#include <algorithm>
#include <cmath>

#include "evaluation/claims.hpp"
#include "evaluation/exploring_hand.hpp"
#include "evaluation/performance/paper_table.hpp"
#include "evaluation/timing.hpp"

namespace palpate::evaluation {
namespace {

TEST(Performance, claims_hold_in_quick_mode) {
    const Result result = quick_result(performance);
    EXPECT_EQ(result.claims.size(), 3U);
    EXPECT_EQ(result.table.rows().size(), 12U);  // 2 volumes, 2 resolutions, 3 methods
    EXPECT_EQ(result.table.number(0, "paper_mean_us"), 52);
    EXPECT_EQ(result.table.number(3, "paper_mean_us"), 72);
    EXPECT_EQ(result.summary.rows().size(), 4U);
    EXPECT_NEAR(result.summary.number(0, "hand in the paper [cm/s]"), 9.54, 1e-9);
}

TEST(Performance, same_seed_gives_the_same_table_but_for_the_times) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("torus:40x40x20"));
    const Table once = performance(options).table, again = performance(options).table;
    options.seed = 2;
    const Table other = performance(options).table;
    bool differs = false;
    for (std::size_t i = 0; i < once.rows().size(); ++i) {
        for (const char* column : {"speed_mm_s", "constrained_share", "depth_mm", "updates",
                                   "tetrahedra_per_update", "unfinished_updates"}) {
            EXPECT_EQ(once.number(i, column), again.number(i, column)) << column;
            differs = differs || once.number(i, column) != other.number(i, column);
        }
    }
    EXPECT_TRUE(differs);
}

TEST(Performance, on_a_body_too_ragged_for_the_hand_there_is_a_note_and_no_claim) {
    Options options = quick_options();
    // On larger noise the hand keeps to its targets for one seed in six, and which seeds these are
    // depends on the last bits of the processor's sines.
    options.subjects.push_back(synthetic("noise:4x4x4"));
    std::string notes;
    options.note = [&](const std::string& text) { notes += text; };
    EXPECT_EQ(performance(options).claims.size(), 2U);
    EXPECT_NE(notes.find("very small"), std::string::npos);
}

TEST(ExploringHand, comes_within_two_percent_of_the_wanted_speed_and_share) {
    const Subject torus = synthetic("torus");
    for (const double share : {0.3, 0.8}) {
        ExploringHand hand;
        hand.trajectories = 4;
        const TunedHand tuned = tuned_hand(torus, hand, {30, share});
        EXPECT_NEAR(tuned.behaviour.speed_mm_s, 30, 0.02 * 30);
        EXPECT_NEAR(tuned.behaviour.constrained_share, share, 0.02 * share);
        const Behaviour again = behaviour_of(torus, tuned.trajectories, hand.rate_hz);
        EXPECT_EQ(again.constrained_share, tuned.behaviour.constrained_share);
    }
}

TEST(ExploringHand, is_never_faster_than_its_swelling_speed) {
    const Subject noise = synthetic("noise:24x24x24");
    ExploringHand hand;
    hand.trajectories = 2;
    for (const Trajectory& trajectory : explore(noise, hand)) {
        EXPECT_EQ(trajectory.size(), 5001U);
        for (std::size_t i = 1; i < trajectory.size(); ++i) {
            EXPECT_LE((trajectory[i] - trajectory[i - 1]).norm(), 1.8 * 0.05 + 1e-12);
        }
    }
}

TEST(ExploringHand, presses_more_lightly_on_a_body_too_fine_for_it) {
    ExploringHand hand;
    hand.trajectories = 4;
    hand.speed_mm_s = 150;
    hand.depth_mm = 6;
    const TunedHand tuned = tuned_hand(synthetic("torus:40x40x20"), hand, {150, 0.9});
    EXPECT_LT(tuned.hand.depth_mm, 6);
    EXPECT_NEAR(tuned.behaviour.constrained_share, 0.9, 0.15 * 0.9);
}

TEST(ExploringHand, a_level_without_a_surface_is_refused) {
    EXPECT_THROW(explore(synthetic("sphere", 500), {}), std::invalid_argument);
    EXPECT_THROW(explore(synthetic("sphere", -5), {}), std::invalid_argument);
}

TEST(UpdateTimes, counts_are_the_methods_own_and_percentiles_are_in_order) {
    const Subject sphere = synthetic("sphere:32x32x32");
    ExploringHand hand;
    hand.trajectories = 2;
    hand.trajectory_s = 0.5;
    const auto trajectories = explore(sphere, hand);
    const UpdateTimes times = time_updates(sphere, &update_exact, trajectories, {3, 5});
    std::int64_t tetrahedra = 0, constrained = 0;
    for (const Trajectory& trajectory : trajectories) {
        Proxy proxy;
        place(proxy, sphere.field, trajectory.front(), sphere.isovalue);
        for (std::size_t i = 1; i < trajectory.size(); ++i) {
            const ProxyUpdate update = update_exact(proxy, sphere.field, trajectory[i]);
            tetrahedra += update.tetrahedra;
            constrained += update.mode == Mode::constrained;
        }
    }
    EXPECT_EQ(times.updates, 1000);
    EXPECT_EQ(times.tetrahedra, tetrahedra);
    EXPECT_EQ(times.constrained, constrained);
    EXPECT_GT(times.p50_ns, 0);
    EXPECT_LE(times.p50_ns, times.p99_ns);
    EXPECT_LE(times.p99_ns, times.p999_ns);
    EXPECT_LE(times.p999_ns, times.max_ns);
    EXPECT_LE(times.max_ns, times.interrupted_max_ns);
    EXPECT_GT(times.cold_p50_ns, 0);
}

TEST(PaperTable, a_row_has_the_speeds_and_shares_of_both_resolutions) {
    const PaperRow* const orange = paper_row("orange");
    ASSERT_NE(orange, nullptr);
    EXPECT_EQ(orange->at[0].mean_us, 55);
    EXPECT_EQ(orange->at[1].speed_mm_s, 30.2);
    EXPECT_EQ(orange->at[1].constrained_share, 0.606);
    EXPECT_EQ(paper_row("bonsai"), nullptr);
}

TEST(Performance, a_volume_of_the_user_has_our_target_and_no_row_of_the_paper) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("torus:40x40x20"));
    const Result result = performance(options);
    EXPECT_EQ(result.table.text(0, "target_from"), "ours");
    EXPECT_TRUE(std::isnan(result.table.number(0, "paper_mean_us")));
    EXPECT_TRUE(result.summary.rows().empty());
}

}  // namespace
}  // namespace palpate::evaluation
