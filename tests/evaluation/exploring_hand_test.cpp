// The hand that explores.
#include <gtest/gtest.h>

#include <stdexcept>

#include "evaluation/exploring_hand.hpp"

namespace palpate::evaluation {
namespace {

TEST(ExploringHand, comes_within_two_percent_of_the_wanted_speed_and_share) {
    const Subject torus = subject_from("synthetic:torus");
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
    const Subject noise = subject_from("synthetic:noise:24x24x24");
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
    const TunedHand tuned = tuned_hand(subject_from("synthetic:torus:40x40x20"), hand, {150, 0.9});
    EXPECT_LT(tuned.hand.depth_mm, 6);
    EXPECT_NEAR(tuned.behaviour.constrained_share, 0.9, 0.15 * 0.9);
}

TEST(ExploringHand, a_level_without_a_surface_is_refused) {
    EXPECT_THROW(explore(subject_from("synthetic:sphere@500"), {}), std::invalid_argument);
    EXPECT_THROW(explore(subject_from("synthetic:sphere@-5"), {}), std::invalid_argument);
}

TEST(ExploringHand, stops_when_it_is_told_so_in_a_tick) {
    int ticks = 0;
    const auto alive = [&] {
        if (++ticks == 100) throw std::runtime_error("stopped");
    };
    const Subject sphere = subject_from("synthetic:sphere:24x24x24");
    EXPECT_THROW(explore(sphere, {}, alive), std::runtime_error);
    EXPECT_EQ(ticks, 100);
    EXPECT_THROW(tuned_hand(sphere, {}, {50, 0.6}, [] { throw std::runtime_error("stopped"); }),
                 std::runtime_error);
}

}  // namespace
}  // namespace palpate::evaluation
