// Orientation and torque of the device `openhaptics`, on models with and without motors for it.
#include "devices/openhaptics/openhaptics_fixture.hpp"
#include "devices/vendor_wrist_cases.hpp"

namespace palpate::devices {
namespace {

class OpenHapticsTorque : public OpenHaptics {
  protected:
    OpenHapticsTorque() {
        with([](auto& hd) { hd.output_dof = 6; });
    }
    // For cases that all vendors share.
    double largest_torque() const {
        return with([](auto& hd) { return hd.largest_torque; });
    }
    void take_motors_away() {
        with([](auto& hd) { hd.output_dof = 3; });  // the stand-in complains of a torque
    }
    std::string fail_torque(bool on) {
        with([&](auto& hd) { hd.torque_error = on ? 0x102 : 0; });
        return "Invalid operation";
    }
    void tell_rotation_with(double one) {
        with([&](auto& hd) { hd.transform[5] = one; });
    }
    void tell_position(const Vec3& mm) {
        with([&](auto& hd) { hd.position = {mm[0], mm[1], mm[2]}; });
    }
    void slow_down(std::chrono::milliseconds time) {
        with([&](auto& hd) { hd.while_beginning = [time] { pass(time); }; });
    }
};
INSTANTIATE_TYPED_TEST_SUITE_P(OpenHaptics, VendorWrist, OpenHapticsTorque);

TEST_F(OpenHapticsTorque, only_a_device_with_six_degrees_of_output_renders_torque) {
    EXPECT_TRUE(open()->info().renders_torque);
    EXPECT_EQ(open()->info().limits.maximum_torque, 170);
    with([](auto& hd) { hd.most_torque = 0.17; });  // other units, or nonsense
    EXPECT_EQ(open()->info().limits.maximum_torque, 48);
    with([](auto& hd) { hd.output_dof = 3; });
    EXPECT_TRUE(open()->info().has_orientation);
    EXPECT_FALSE(open()->info().renders_torque);
    EXPECT_EQ(open()->info().limits.maximum_torque, 0);
    with([](auto& hd) { hd.input_dof = 3; });
    EXPECT_FALSE(open()->info().has_orientation);
}

TEST_F(OpenHapticsTorque, a_device_that_measures_no_orientation_may_tell_any) {
    with([](auto& hd) {
        hd.input_dof = 3;
        hd.transform[5] = 7;
    });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_EQ(device->read(0).orientation, Mat3(Mat3::Identity()));
}

}  // namespace
}  // namespace palpate::devices
