// The whole loop of hand, device and renderer, for a person who presses and holds.
#include "devices/simulated/closed_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "devices/simulated/profiles.hpp"

namespace palpate::devices {
namespace {

constexpr double seconds = 3;
const std::string hold = ",hand=hold,depth=6,seconds=3";

class EveryProfile : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ClosedLoop, EveryProfile, testing::ValuesIn(profile_names()));

TEST_P(EveryProfile, comes_to_rest_at_its_rated_stiffness_in_every_grip) {
    const Body body;
    const double step = profile(GetParam()).encoder_step;
    for (const std::string& grip : grip_names()) {
        SCOPED_TRACE(grip);
        const auto device = body.open(GetParam() + ",grip=" + grip + hold);
        const double stiffness = device->info().stiffness;
        const Held held = press(body, *device, stiffness, seconds, true);
        EXPECT_TRUE(held.constrained);
        EXPECT_GT(held.push, 0.25);
        EXPECT_LE(held.position.greatest(), 1.01 * step);
        EXPECT_LE(held.force.greatest(), 1.5 * stiffness * step);
    }
}

TEST_P(EveryProfile, hunts_over_one_encoder_step_or_5_micrometres_at_most_without_friction) {
    const Body body;
    const auto device = body.open(GetParam() + ",friction=no" + hold);
    const Held held = press(body, *device, device->info().stiffness, seconds, true);
    EXPECT_TRUE(held.constrained);
    EXPECT_LE(held.position.greatest(), std::max(1.01 * profile(GetParam()).encoder_step, 0.005));
}

// The controls: what the tests above look for does happen.

TEST_P(EveryProfile, is_thrown_about_by_an_absurd_stiffness) {
    const Body body;
    const auto device = body.open(GetParam() + ",grip=light,friction=no" + hold);
    const Held held = press(body, *device, 8 * device->info().stiffness, seconds, true);
    EXPECT_GT(held.position.greatest(), 5 * profile(GetParam()).encoder_step);
    EXPECT_GT(held.force.greatest(), 0.5);
}

TEST(ClosedLoop, a_long_delay_makes_a_limit_cycle_of_a_stiffness_that_rests_without) {
    const Body body;
    const std::string weak = "inverse3,grip=light,friction=no,encoder=0" + hold;
    const Held prompt = press(body, *body.open(weak + ",delay=0"), 1, seconds);
    const auto delayed = body.open(weak + ",delay=10");
    EXPECT_LT(greatest_stiffness(delayed->info().limits, 0), 0.25);  // check() refuses it
    const Held late = press(body, *delayed, 1, seconds, true);
    EXPECT_LT(prompt.position.greatest(), 0.01);
    EXPECT_GT(late.position.greatest(), 0.5);
}

TEST(ClosedLoop, friction_stills_what_hunts_without_it) {
    const Body body;
    const std::string coarse = "omni,grip=light" + hold;
    const Held with = press(body, *body.open(coarse), 2.8, seconds, true);
    const Held without = press(body, *body.open(coarse + ",friction=no"), 2.8, seconds, true);
    EXPECT_EQ(with.position.greatest(), 0);
    EXPECT_GT(without.position.greatest(), 5 * profile("omni").encoder_step);
}

TEST(ClosedLoop, the_hand_pushes_as_hard_as_two_springs_in_a_row) {
    const Body body;
    const auto device = body.open("omni,friction=no,encoder=0,force_step=0" + hold);
    const Held held = press(body, *device, 0.7, seconds);
    const double k = grip("normal").stiffness;
    EXPECT_NEAR(held.push, 6 * k * 0.7 / (k + 0.7), 0.02);
}

}  // namespace
}  // namespace palpate::devices
