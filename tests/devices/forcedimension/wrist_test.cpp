// The wrist of a Force Dimension device: torque, centring, and how it fails.
#include "devices/forcedimension/forcedimension_fixture.hpp"
#include "devices/vendor_wrist_cases.hpp"

namespace palpate::devices {
namespace {

class ForceDimensionWrist : public ForceDimension {
  protected:
    ForceDimensionWrist() { plug_in(MOCK_DRD); }
    void plug_in(const char* path) {
        use(path);
        with([](auto& dhd) {
            dhd.type = 104;
            dhd.active_wrist = true;
        });
    }
    // For cases that all vendors share.
    double largest_torque() const {
        return with([](auto& dhd) { return 1000 * dhd.largest_torque; });
    }
    void take_motors_away() {
        with([](auto& dhd) { dhd.type = 35; });  // though its library has an active one
    }
    std::string fail_torque(bool on) {
        with([&](auto& dhd) { dhd.torque_error = on ? 8 : 0; });
        return "geometry error";
    }
    void tell_rotation_with(double one) {
        with([&](auto& dhd) { dhd.frame[1][1] = one; });
    }
    void tell_position(const Vec3& mm) {
        with([&](auto& dhd) { dhd.position = {1e-3 * mm[2], 1e-3 * mm[0], 1e-3 * mm[1]}; });
    }
    void slow_down(std::chrono::milliseconds time) {
        with([&](auto& dhd) { dhd.while_reading = [time] { pass(time); }; });
    }
};
INSTANTIATE_TYPED_TEST_SUITE_P(ForceDimension, VendorWrist, ForceDimensionWrist);

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
    for (const char* path : {MOCK_DRD, MOCK_DHD}) {  // each has another function for it
        plug_in(path);
        const auto device = open();
        EXPECT_TRUE(turns(*device, Vec3(-30, 50, 7)));
        EXPECT_EQ(with([](auto& dhd) { return dhd.wrong_id; }), 0);
        EXPECT_NEAR(with([](auto& dhd) { return dhd.max_torque; }), 0.2, 1e-12);
        EXPECT_TRUE(has_no_problem(*device));
    }
}

TEST_F(ForceDimensionWrist, is_lost_where_a_call_for_torque_or_orientation_finds_no_device) {
    const auto device = open();
    ASSERT_TRUE(turns(*device));
    with([](auto& dhd) { dhd.torque_error = 2; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::lost));
    with([](auto& dhd) { dhd.torque_error = 0; });
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
