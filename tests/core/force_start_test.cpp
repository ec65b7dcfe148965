// Force: waiting for a small force at the start, release, and start after a release.
#include <gtest/gtest.h>

#include <limits>

#include "palpate/force.hpp"
#include "support/constants.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

struct Contact {
    ForceSettings settings;
    DeviceLimits limits{};
    ForceState state{};
    ForceInput input{};

    explicit Contact(double start_below, double rate_limit = 1e6, double ramp = 0) {
        settings.start_below = start_below;
        settings.rate_limit = rate_limit;
        settings.ramp = ramp;
        settings.stiffness = 1;
        input.constrained = true;
    }
    ForceResult press(double depth) {
        input.time += period;
        input.pull = Vec3(0, 0, depth);
        return render_force(state, settings, limits, input);
    }
};

TEST(ForceStart, waits_until_the_wanted_force_is_small) {
    Contact contact(0.3);
    for (int i = 0; i < 100; ++i) {
        const ForceResult result = contact.press(2);
        EXPECT_EQ(result.force, Vec3(0, 0, 0));
        EXPECT_EQ(result.flags, force_waiting);
    }
    EXPECT_EQ(contact.press(0.3).force[2], 0.3);
    EXPECT_EQ(contact.press(2).force[2], 2);
    EXPECT_EQ(contact.press(2).flags, 0);
}

TEST(ForceStart, does_not_wait_unless_asked) {
    Contact contact(std::numeric_limits<double>::infinity());
    contact.press(2);  // the first has no time to rise in
    EXPECT_EQ(contact.press(2).force[2], 2);
}

TEST(ForceStart, the_ramp_begins_when_the_waiting_ends) {
    Contact contact(0.5, 1e6, 0.1);
    for (int i = 0; i < 300; ++i) contact.press(3);
    contact.press(0.4);
    double last = 0;
    for (int i = 1; i < 100; ++i) {
        const ForceResult result = contact.press(2);
        EXPECT_NEAR(result.force[2], 2 * i / 100.0, 1e-9);
        EXPECT_GT(result.force[2], last);
        last = result.force[2];
    }
}

TEST(ForceStart, waits_again_after_a_pause) {
    Contact contact(0.3);
    contact.press(0.1);
    EXPECT_EQ(contact.press(2).force[2], 2);
    contact.input.time += 1;
    EXPECT_EQ(contact.press(2).force[2], 0);
    EXPECT_EQ(contact.press(2).flags, force_waiting);
}

TEST(ForceStart, a_release_falls_within_the_rate_limit_and_comes_back_by_ramp) {
    Contact contact(std::numeric_limits<double>::infinity(), 100, 0.05);  // 0.1 N a tick
    for (int i = 0; i < 200; ++i) contact.press(1);
    EXPECT_NEAR(contact.state.force[2], 1, 1e-9);
    contact.input.released = true;
    double last = 1;
    for (int i = 0; i < 12; ++i) {
        const double force = contact.press(1).force[2];
        EXPECT_LE(last - force, 0.1 + 1e-9);
        last = force;
    }
    EXPECT_EQ(last, 0);
    contact.input.released = false;
    EXPECT_LT(contact.press(1).force[2], 0.05);
    for (int i = 0; i < 60; ++i) contact.press(1);
    EXPECT_NEAR(contact.state.force[2], 1, 1e-9);
}

TEST(ForceStart, a_start_force_below_zero_or_not_a_number_is_refused) {
    for (const double wrong : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
        ForceSettings settings;
        settings.start_below = wrong;
        EXPECT_THROW(check(settings, {}), std::invalid_argument);
    }
}

}  // namespace
