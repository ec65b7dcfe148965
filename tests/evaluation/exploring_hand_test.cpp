// The hand that explores, and how updates are timed.
#include <gtest/gtest.h>

#include "evaluation/exploring_hand.hpp"
#include "evaluation/timing.hpp"

namespace palpate::evaluation {
namespace {

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

}  // namespace
}  // namespace palpate::evaluation
