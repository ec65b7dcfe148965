// The wrist of a Force Dimension device: torque, centring, and how it fails.
#include <limits>

#include "devices/forcedimension/forcedimension_fixture.hpp"

namespace palpate::devices {
namespace {

class ForceDimensionWrist : public ForceDimension {
  protected:
    void SetUp() override { plug_in(MOCK_DRD); }
    void plug_in(const char* library) {
        use(library);
        with([](auto& dhd) {
            dhd.type = 104;
            dhd.active_wrist = true;
        });
    }
};

TEST_F(ForceDimensionWrist, a_model_with_motors_at_its_wrist_says_so_and_any_other_does_not) {
    const DeviceInfo sigma = open()->info();
    EXPECT_TRUE(sigma.has_orientation);
    EXPECT_TRUE(sigma.renders_torque);
    EXPECT_EQ(sigma.limits.maximum_torque, 200);
    with([](auto& dhd) { dhd.active_wrist = false; });
    EXPECT_FALSE(open()->info().renders_torque);
    EXPECT_EQ(open()->info().limits.maximum_torque, 0);
    for (const int omega : {34, 35, 36, 37}) {
        with([&](auto& dhd) { dhd.type = omega; });
        const DeviceInfo info = open()->info();
        EXPECT_TRUE(info.has_orientation);
        EXPECT_FALSE(info.renders_torque);
    }
}

TEST_F(ForceDimensionWrist, a_torque_arrives_in_newton_metres_in_the_axes_it_was_written_in) {
    for (const char* library : {MOCK_DRD, MOCK_DHD}) {  // each has another function for it
        plug_in(library);
        const auto device = open();
        EXPECT_TRUE(turns(*device, Vec3(-30, 50, 7)));
        EXPECT_EQ(with([](auto& dhd) { return dhd.wrong_id; }), 0);
        EXPECT_NEAR(with([](auto& dhd) { return dhd.max_torque; }), 0.2, 1e-12);
        EXPECT_TRUE(has_no_problem(*device));
    }
}

TEST_F(ForceDimensionWrist, a_torque_beyond_the_devices_own_is_cut_to_it) {
    const auto device = open();
    const Vec3 cut = Vec3(0.6, 0, 0.8) * 0.2;
    EXPECT_TRUE(within(
        felt, [&] { return (torque() - cut).norm() < 1e-12; },
        [&] {
            device->write({Vec3::Zero(), Vec3(6000, 0, 8000)}, 0);
        }));
    EXPECT_LE(with([](auto& dhd) { return dhd.largest_torque; }), 0.2 + 1e-12);
}

TEST_F(ForceDimensionWrist, a_passive_wrist_is_never_sent_a_torque) {
    with([](auto& dhd) { dhd.type = 35; });  // though its library has an active one
    const auto device = open();
    EXPECT_TRUE(within(
        felt, [&] { return (force() - Vec3(1, 2, 0)).norm() < 1e-12; },
        [&] {
            device->write({Vec3(1, 2, 0), Vec3(50, 0, 0)}, 0);
        }));
    EXPECT_EQ(with([](auto& dhd) { return dhd.largest_torque; }), 0);
}

TEST_F(ForceDimensionWrist, force_and_torque_go_to_zero_when_stopped_silent_or_closed) {
    auto device = open();
    ASSERT_TRUE(turns(*device));
    EXPECT_TRUE(goes_to_zero_in_silence());
    ASSERT_TRUE(turns(*device));
    device->stop();
    EXPECT_TRUE(stays_at_zero(*device));
    device.reset();
    device = open();
    ASSERT_TRUE(turns(*device));
    device.reset();
    EXPECT_EQ(with([](auto& dhd) { return dhd.force_at_stop; }), (std::array<double, 3>{}));
    EXPECT_TRUE(torque().isZero(0));
}

TEST_F(ForceDimensionWrist, a_failing_torque_call_is_a_fault_that_leaves_no_force) {
    const auto device = open();
    ASSERT_TRUE(turns(*device));
    with([](auto& dhd) { dhd.torque_error = 8; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(says(*device, "geometry error"));
    EXPECT_TRUE(stays_at_zero(*device));
    with([](auto& dhd) { dhd.torque_error = 2; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::lost));
    with([](auto& dhd) { dhd.torque_error = 0; });
    EXPECT_TRUE(turns(*device));
    EXPECT_TRUE(has_no_problem(*device));
}

TEST_F(ForceDimensionWrist, an_orientation_that_is_no_rotation_is_a_fault_and_never_told) {
    const auto device = open();
    const auto set = [&](double a, double b, double c) {
        with([&](auto& dhd) {
            dhd.frame[0][0] = a;
            dhd.frame[1][1] = b;
            dhd.frame[2][2] = c;
        });
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Vec3& wrong : {Vec3(nan, 1, 1), Vec3(1, 1, -1), Vec3(1.1, 1, 1), Vec3(0, 0, 0)}) {
        set(1, 1, 1);
        ASSERT_TRUE(turns(*device));
        set(wrong[0], wrong[1], wrong[2]);
        ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
        EXPECT_TRUE(says(*device, "an orientation that cannot be"));
        EXPECT_EQ(device->read(0).orientation, Mat3(Mat3::Identity()));
        EXPECT_TRUE(stays_at_zero(*device));
    }
    set(1, 1, 1);
    ASSERT_TRUE(turns(*device));
    with([](auto& dhd) { dhd.orientation_error = 7; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::lost));
    EXPECT_TRUE(stays_at_zero(*device));
}

TEST_F(ForceDimensionWrist, a_wrist_that_is_not_initialised_has_no_force_until_it_is) {
    with([](auto& dhd) { dhd.wrist_initialised = false; });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
    EXPECT_TRUE(says(*device, "the wrist is not initialised"));
    EXPECT_TRUE(stays_at_zero(*device));
    with([](auto& dhd) { dhd.wrist_initialised = true; });
    EXPECT_TRUE(turns(*device));
    with([](auto& dhd) { dhd.wrist_initialised = false; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
    EXPECT_TRUE(stays_at_zero(*device));
}

TEST_F(ForceDimensionWrist, autoinit_initialises_a_wrist_too) {
    with([](auto& dhd) { dhd.wrist_initialised = false; });
    const auto device = open(",autoinit=yes");
    EXPECT_TRUE(within(soon, [&] { return called("initialise") == 1; }));
    with([](auto& dhd) { dhd.wrist_initialised = true; });
    EXPECT_TRUE(turns(*device));
}

TEST_F(ForceDimensionWrist, is_centred_only_when_asked_for_alone_and_is_let_go_of_again) {
    {
        const auto device = open();
        ASSERT_TRUE(turns(*device));
        EXPECT_EQ(called("turn"), 0);
    }
    const auto device = open(",centre=yes");
    int told = 0;
    with([&](auto& dhd) {
        dhd.while_centring = [&] {
            pass(1s);
            told += device->read(0).status == DeviceStatus::uncalibrated &&
                    contains(device->problem(), "keep your hands off");
        };
    });
    step();
    EXPECT_TRUE(turns(*device));
    EXPECT_EQ(told, 1);
    EXPECT_EQ(with([](auto& dhd) { return dhd.turned_to_centre; }), 1);
    EXPECT_FALSE(with([](auto& dhd) { return dhd.is_regulating || dhd.regulates_rotation; }));
    EXPECT_TRUE(has_no_problem(*device));
}

TEST_F(ForceDimensionWrist, cannot_be_centred_without_motors_or_without_libdrd) {
    with([](auto& dhd) { dhd.active_wrist = false; });
    EXPECT_TRUE(contains(refusal(",centre=yes"), "has no motors at its wrist"));
    plug_in(MOCK_DHD);
    EXPECT_TRUE(contains(refusal(",centre=yes"), "install libdrd"));
}

}  // namespace
}  // namespace palpate::devices
