// Cases that every backend of a vendor's library has to pass with a device that has motors at its
// wrist. A test program instantiates the suite with its fixture.
#pragma once

#include <limits>
#include <string>

#include "devices/vendor_device.hpp"

namespace palpate::devices {

/// `Backend` is a VendorDevice with the members that the cases use.
template <class Backend>
class VendorWrist : public Backend {};
TYPED_TEST_SUITE_P(VendorWrist);

TYPED_TEST_P(VendorWrist, gives_a_torque_in_the_axes_it_was_written_in_cut_to_the_devices_own) {
    const auto device = this->open();
    EXPECT_TRUE(device->info().renders_torque);
    EXPECT_TRUE(this->turns(*device, Vec3(-30, 50, 7)));
    const double most = device->info().limits.maximum_torque;
    const Wrench far{Vec3::Zero(), Vec3(6000, 0, 8000)};
    EXPECT_TRUE(this->is_given(*device, far, {Vec3::Zero(), Vec3(0.6, 0, 0.8) * most}, this->felt));
    EXPECT_LE(this->largest_torque(), most + 1e-9);
    EXPECT_TRUE(this->has_no_problem(*device));
}

TYPED_TEST_P(VendorWrist, without_motors_is_never_sent_a_torque) {
    this->take_motors_away();
    const auto device = this->open();
    const Wrench wrench{Vec3(1, 2, 0), Vec3(50, 0, 0)};
    EXPECT_TRUE(this->is_given(*device, wrench, {wrench.force}, this->felt));
    EXPECT_TRUE(this->throughout(
        50ms, [&] { return device->read(0).status == DeviceStatus::ready; },
        [&] { device->write(wrench, 0); }));
    EXPECT_EQ(this->largest_torque(), 0);
}

TYPED_TEST_P(VendorWrist, loses_force_and_torque_when_stopped_silent_or_closed) {
    auto device = this->open();
    ASSERT_TRUE(this->turns(*device));
    EXPECT_TRUE(this->goes_to_zero_in_silence());
    ASSERT_TRUE(this->turns(*device));
    device->stop();
    EXPECT_TRUE(this->stays_at_zero(*device));
    device.reset();
    device = this->open();
    ASSERT_TRUE(this->turns(*device));
    device.reset();
    EXPECT_TRUE(this->is_zero());
}

TYPED_TEST_P(VendorWrist, whose_torque_call_fails_has_no_force_until_it_works_again) {
    const auto device = this->open();
    ASSERT_TRUE(this->turns(*device));
    const std::string words = this->fail_torque(true);
    ASSERT_TRUE(this->becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(this->says(*device, words)) << device->problem();
    EXPECT_TRUE(this->stays_at_zero(*device));
    this->fail_torque(false);
    EXPECT_TRUE(this->becomes(*device, DeviceStatus::ready, 1s + this->felt));
    EXPECT_TRUE(this->turns(*device));
    EXPECT_TRUE(this->has_no_problem(*device));
}

TYPED_TEST_P(VendorWrist, that_tells_no_rotation_is_a_fault_and_its_orientation_is_never_told) {
    const auto device = this->open();
    for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), -1.0, 0.0, 1.01, 1.1}) {
        this->tell_rotation_with(1);
        ASSERT_TRUE(this->turns(*device));
        this->tell_rotation_with(wrong);
        ASSERT_TRUE(this->becomes(*device, DeviceStatus::fault));
        EXPECT_TRUE(this->says(*device, "an orientation that cannot be"));
        EXPECT_EQ(device->read(0).orientation, Mat3(Mat3::Identity()));
        EXPECT_TRUE(this->stays_at_zero(*device));
    }
}

TYPED_TEST_P(VendorWrist, that_tells_no_position_is_a_fault_and_its_position_is_never_told) {
    const auto device = this->open();
    for (const Vec3& absurd : {Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0),
                               Vec3(0, 10001, 0), Vec3(0, 0, -1e300)}) {
        this->tell_position(Vec3(1, 2, 3));
        ASSERT_TRUE(this->presses(*device));
        this->tell_position(absurd);
        ASSERT_TRUE(this->becomes(*device, DeviceStatus::fault));
        EXPECT_LE((device->read(0).position - Vec3(1, 2, 3)).norm(), 1e-12);
        EXPECT_TRUE(this->says(*device, "a position that cannot be"));
        EXPECT_TRUE(this->stays_at_zero(*device));
    }
}

TYPED_TEST_P(VendorWrist, whose_library_is_slow_is_never_ready_and_gets_no_force) {
    this->slow_down(50ms);
    const auto device = this->open();
    ASSERT_TRUE(this->becomes(*device, DeviceStatus::stale));
    EXPECT_TRUE(this->throughout(
        300ms, [&] { return device->read(0).status != DeviceStatus::ready && this->is_zero(); },
        [&] { device->write({Vec3(1, 1, 1)}, 0); }));
    this->slow_down(0ms);
    EXPECT_TRUE(this->presses(*device));
}

REGISTER_TYPED_TEST_SUITE_P(VendorWrist,
                            gives_a_torque_in_the_axes_it_was_written_in_cut_to_the_devices_own,
                            without_motors_is_never_sent_a_torque,
                            loses_force_and_torque_when_stopped_silent_or_closed,
                            whose_torque_call_fails_has_no_force_until_it_works_again,
                            that_tells_no_rotation_is_a_fault_and_its_orientation_is_never_told,
                            that_tells_no_position_is_a_fault_and_its_position_is_never_told,
                            whose_library_is_slow_is_never_ready_and_gets_no_force);

}  // namespace palpate::devices
