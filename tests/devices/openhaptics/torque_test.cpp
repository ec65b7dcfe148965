// Orientation and torque of the device `openhaptics`, on models with and without motors for it.
#include <limits>

#include "devices/openhaptics/openhaptics_fixture.hpp"

namespace palpate::devices {
namespace {

class OpenHapticsTorque : public OpenHaptics {
  protected:
    void SetUp() override {
        OpenHaptics::SetUp();
        with([](MockHd& hd) { hd.output_dof = 6; });
    }
};

TEST_F(OpenHapticsTorque, only_a_device_with_six_degrees_of_output_renders_torque) {
    EXPECT_TRUE(open()->info().renders_torque);
    EXPECT_EQ(open()->info().limits.maximum_torque, 170);
    with([](MockHd& hd) { hd.most_torque = 0.17; });  // other units, or nonsense
    EXPECT_EQ(open()->info().limits.maximum_torque, 48);
    with([](MockHd& hd) { hd.output_dof = 3; });
    EXPECT_TRUE(open()->info().has_orientation);
    EXPECT_FALSE(open()->info().renders_torque);
    EXPECT_EQ(open()->info().limits.maximum_torque, 0);
    with([](MockHd& hd) { hd.input_dof = 3; });
    EXPECT_FALSE(open()->info().has_orientation);
}

TEST_F(OpenHapticsTorque, a_torque_arrives_in_millinewton_metres_and_is_cut_to_the_devices_own) {
    const auto device = open();
    EXPECT_TRUE(turns(*device, Vec3(-30, 50, 7)));
    const Vec3 cut = Vec3(0.6, 0, 0.8) * 170;
    EXPECT_TRUE(within(
        soon, [&] { return (torque() - cut).norm() < 1e-9; },
        [&] {
            device->write({Vec3::Zero(), Vec3(600, 0, 800)}, 0);
        }));
    EXPECT_LE(with([](MockHd& hd) { return hd.largest_torque; }), 170 + 1e-9);
    EXPECT_TRUE(has_no_problem(*device));
}

TEST_F(OpenHapticsTorque, a_device_without_torque_is_never_sent_one) {
    with([](MockHd& hd) { hd.output_dof = 3; });  // the stand-in complains of one
    const auto device = open();
    EXPECT_TRUE(within(
        soon, [&] { return (force() - Vec3(1, 2, 0)).norm() < 1e-12; },
        [&] {
            device->write({Vec3(1, 2, 0), Vec3(50, 0, 0)}, 0);
        }));
    EXPECT_TRUE(throughout(
        50ms, [&] { return device->read(0).status == DeviceStatus::ready; },
        [&] {
            device->write({Vec3(1, 2, 0), Vec3(50, 0, 0)}, 0);
        }));
}

TEST_F(OpenHapticsTorque, force_and_torque_go_to_zero_when_stopped_silent_or_closed) {
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
    EXPECT_TRUE(force().isZero(0) && torque().isZero(0));
}

TEST_F(OpenHapticsTorque, an_error_of_the_torque_call_is_a_fault_without_force) {
    const auto device = open();
    ASSERT_TRUE(turns(*device));
    with([](MockHd& hd) { hd.torque_error = 0x102; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(stays_at_zero(*device));
    EXPECT_TRUE(contains(device->problem(), "Invalid operation")) << device->problem();
    with([](MockHd& hd) { hd.torque_error = 0; });
    EXPECT_TRUE(turns(*device, Vec3(10, 20, 30), 1s + felt));
}

TEST_F(OpenHapticsTorque, an_orientation_that_is_no_rotation_is_a_fault_and_never_told) {
    const auto device = open();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double wrong : {nan, -1.0, 0.0, 1.01}) {
        with([](MockHd& hd) { hd.transform[5] = 1; });
        ASSERT_TRUE(turns(*device));
        with([&](MockHd& hd) { hd.transform[5] = wrong; });
        ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
        EXPECT_TRUE(contains(device->problem(), "an orientation that cannot be"));
        EXPECT_EQ(device->read(0).orientation, Mat3(Mat3::Identity()));
        EXPECT_TRUE(stays_at_zero(*device));
    }
}

TEST_F(OpenHapticsTorque, a_device_that_measures_no_orientation_may_tell_any) {
    with([](MockHd& hd) {
        hd.input_dof = 3;
        hd.transform[5] = 7;
    });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_EQ(device->read(0).orientation, Mat3(Mat3::Identity()));
}

}  // namespace
}  // namespace palpate::devices
