// The spring that opens a gripper: its force, its direction, and when there is none.
#include <cmath>

#include "devices/forcedimension/forcedimension_fixture.hpp"

namespace palpate::devices {
namespace {

class Gripper : public ForceDimension, public testing::WithParamInterface<int> {
  protected:
    void plug(int type) {
        with([&](auto& dhd) {
            dhd.type = type;
            dhd.active_wrist = has_torque();
            dhd.opening = 0;
        });
    }
    static bool has_torque() { return GetParam() >= 104; }
    /// Sign of the force that opens it.
    static double opens() {
        return GetParam() == 37 || GetParam() == 105 || GetParam() == 109 ? -1 : 1;
    }
    double spring() const {
        return with([](auto& dhd) { return dhd.gripper_force; });
    }
    /// The servo renews its force, which is zero, until this spring is felt.
    bool is_driven_to(Device& device, double newtons) {
        return within(
            felt, [&] { return std::abs(spring() - newtons) < 1e-12; },
            [&] { device.write({}, 0); });
    }
};

INSTANTIATE_TEST_SUITE_P(Types, Gripper, testing::Values(35, 37, 104, 105, 108, 109));

TEST_P(Gripper, opens_by_a_spring_that_is_loose_at_half_a_radian) {
    plug(GetParam());
    const auto device = open(",spring=2");
    EXPECT_TRUE(is_driven_to(*device, 2 * opens()));
    with([&](auto& dhd) { dhd.opening = 0.125 * opens(); });
    EXPECT_TRUE(is_driven_to(*device, 1.5 * opens()));
    with([&](auto& dhd) { dhd.opening = 0.7 * opens(); });
    EXPECT_TRUE(is_driven_to(*device, 0));
}

TEST_P(Gripper, has_no_force_unless_it_is_asked_for) {
    plug(GetParam());
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    EXPECT_EQ(spring(), 0);
}

TEST_P(Gripper, has_no_force_once_the_servo_is_silent) {
    plug(GetParam());
    const auto device = open(",spring=2");
    ASSERT_TRUE(is_driven_to(*device, 2 * opens()));
    EXPECT_TRUE(throughout(19ms, [&] { return spring() != 0; }));
    EXPECT_TRUE(within(2ms, [&] { return spring() == 0; }));
}

TEST_P(Gripper, has_no_force_in_any_failure_although_the_servo_goes_on) {
    plug(GetParam());
    const auto ends_it = [&](auto failure) {
        const auto device = open(",spring=2");
        ASSERT_TRUE(is_driven_to(*device, 2 * opens()));
        const MockDhdState sound = with([](auto& dhd) { return dhd; });
        failure(*device);
        const auto renew = [&] { device->write({}, 0); };
        EXPECT_TRUE(within(
            1ms, [&] { return spring() == 0; }, renew));
        EXPECT_TRUE(throughout(
            30ms, [&] { return spring() == 0; }, renew));
        with([&](auto& dhd) { dhd = sound; });
    };
    ends_it([](Device& device) { device.stop(); });
    ends_it([&](Device&) { with([](auto& dhd) { dhd.position_error = 2; }); });
    ends_it([&](Device&) { with([](auto& dhd) { dhd.opening_error = 2; }); });
    ends_it([&](Device&) { with([](auto& dhd) { dhd.opening = std::nan(""); }); });
    if (has_torque()) ends_it([&](Device&) { with([](auto& dhd) { dhd.torque_error = 2; }); });
}

TEST_F(ForceDimension, a_spring_without_a_motor_at_the_gripper_is_refused) {
    EXPECT_TRUE(contains(refusal(",spring=1"), "no gripper with a motor"));  // an omega.3
    with([](auto& dhd) { dhd.type = 35, dhd.active_gripper = false; });
    EXPECT_TRUE(contains(refusal(",spring=1"), "no gripper with a motor"));
    with([](auto& dhd) { dhd.type = 4242, dhd.gripper = dhd.active_gripper = true; });
    EXPECT_TRUE(
        contains(refusal(",spring=1"), "no gripper with a motor"));  // its sign is not known
    EXPECT_TRUE(contains(message_of<std::invalid_argument>([&] { open(",spring=4"); }), "0 to 3"));
}

}  // namespace
}  // namespace palpate::devices
