// The device `openhaptics` against a stand-in for the vendor's library.
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "devices/openhaptics/openhaptics_fixture.hpp"
#include "devices/vendor_cases.hpp"

namespace palpate::devices {
namespace {

TEST_F(OpenHaptics, an_option_that_it_has_not_is_refused) {
    const std::string message = message_of<std::invalid_argument>([&] { open(",speed=1"); });
    EXPECT_TRUE(contains(message, "no option 'speed': use one of name, reset, library")) << message;
}

TEST_F(OpenHaptics, a_driver_without_a_device_is_told_with_its_words_and_can_be_asked_again) {
    with([](auto& hd) { hd.refuses_all = true; });
    const std::string message = refusal();
    EXPECT_TRUE(contains(message, "NULL: Device fault (0x300)")) << message;
    EXPECT_TRUE(contains(message, "'Default PHANToM': Device fault")) << message;
    EXPECT_TRUE(contains(message, "name=NAME")) << message;
    with([](auto& hd) { hd.refuses_all = false; });
    EXPECT_NO_THROW(open());
}

TEST_F(OpenHaptics, where_the_default_device_fails_its_usual_name_is_tried) {
    with([](auto& hd) { hd.refuses_null = true; });
    EXPECT_NO_THROW(open());
    EXPECT_EQ(with([](auto& hd) { return hd.calls.at(2); }), "init Default PHANToM");
}

TEST_F(OpenHaptics, a_name_that_is_given_is_the_only_one_tried) {
    EXPECT_TRUE(contains(refusal(",name=Left Device"), "device 'Left Device': "));
    EXPECT_EQ(with([](auto& hd) { return hd.calls.size(); }), 1U);
    EXPECT_NO_THROW(open(",name=Default PHANToM"));
    with([](auto& hd) { hd.refuses_null = true, hd.only_name = "Default Device"; });
    EXPECT_NO_THROW(open());
}

TEST_F(OpenHaptics, a_servo_loop_that_does_not_start_gives_the_device_back) {
    with([](auto& hd) { hd.refuses_start = true; });
    const std::string message = refusal();
    EXPECT_TRUE(contains(message, "starting the driver's servo loop")) << message;
    EXPECT_FALSE(with([](auto& hd) { return hd.device_open; }));
    with([](auto& hd) { hd.refuses_start = false; });
    EXPECT_NO_THROW(open());
}

TEST_F(OpenHaptics, what_it_can_do_is_read_from_the_device) {
    with([](auto& hd) {
        hd.most_force = 7.9;
        hd.stiffness = 1.5;
        hd.rate = 500;
        hd.workspace = {-100, -50, -60, 110, 70, 90};
    });
    const DeviceInfo info = open()->info();
    EXPECT_EQ(info.name, "openhaptics");
    EXPECT_EQ(info.model, "Mock Touch, serial number 20240001");
    EXPECT_EQ(info.limits.maximum_force, 7.9);
    EXPECT_EQ(info.stiffness, 1.5);
    EXPECT_EQ(info.limits.rate, 500);
    EXPECT_EQ(info.workspace_low, Vec3(-100, -50, -60));
    EXPECT_EQ(info.workspace_high, Vec3(110, 70, 90));
    EXPECT_TRUE(info.has_orientation);
}

TEST_F(OpenHaptics, figures_that_cannot_be_are_replaced_by_those_of_the_smallest_device) {
    with([](auto& hd) {
        hd.most_force = std::numeric_limits<double>::infinity();
        hd.stiffness = -1;
        hd.rate = 0;
        hd.workspace = {80, 60, 35, -80, -60, -35};
    });
    const DeviceInfo info = open("", 250)->info();
    EXPECT_EQ(info.limits.maximum_force, 3.3);
    EXPECT_EQ(info.stiffness, 0.4);
    EXPECT_EQ(info.limits.rate, 250);
    EXPECT_EQ(info.workspace_low, Vec3(-80, -60, -35));
    EXPECT_EQ(info.workspace_high, Vec3(80, 60, 35));
}

TEST_F(OpenHaptics, position_orientation_and_buttons_come_in_the_axes_of_the_device) {
    with([](auto& hd) {
        hd.position = {10, -20, 30};
        hd.transform = {0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 10, -20, 30, 1};
        hd.buttons = 2;
    });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    const DeviceReading reading = device->read(0);
    EXPECT_EQ(reading.position, Vec3(10, -20, 30));
    EXPECT_EQ(reading.orientation.col(0), Vec3(0, 1, 0));  // where the tool's x points
    EXPECT_EQ(reading.orientation.col(1), Vec3(0, 0, 1));
    EXPECT_EQ(reading.orientation.col(2), Vec3(1, 0, 0));
    EXPECT_EQ(reading.buttons, 2U);
    EXPECT_TRUE(has_no_problem(*device));
    with([](auto& hd) { hd.position = {11, 0, 0}; });
    step();
    EXPECT_EQ(device->read(0).position, Vec3(11, 0, 0));
    EXPECT_EQ(with([](auto& hd) { return hd.outside; }), 0);
}

TEST_F(OpenHaptics, a_force_beyond_the_devices_own_is_cut_to_it) {
    const auto device = open();
    EXPECT_TRUE(is_given(*device, {Vec3(30, 40, 0)}, {Vec3(0.6, 0.8, 0) * 3.3}, felt));
    EXPECT_LE(with([](auto& hd) { return hd.largest_force; }), 3.3 + 1e-12);
}

TEST_F(OpenHaptics, it_is_closed_in_order_and_its_last_force_is_zero) {
    auto device = open();
    ASSERT_TRUE(presses(*device));
    device.reset();
    EXPECT_EQ(with([](auto& hd) { return hd.force_at_stop; }), (std::array<double, 3>{}));
    const auto calls = with([](auto& hd) { return hd.calls; });
    const std::vector<std::string> expected{"init NULL",       "enable",         "schedule 65535",
                                            "start scheduler", "stop scheduler", "unschedule",
                                            "disable",         "disable device"};
    EXPECT_EQ(calls, expected);
    const long frames = with([](auto& hd) { return hd.frames; });
    for (int i = 0; i < 20; ++i) step();
    EXPECT_EQ(with([](auto& hd) { return hd.frames; }), frames);
}

TEST_F(OpenHaptics, an_uncalibrated_device_has_no_force_and_says_what_to_do) {
    with([](auto& hd) { hd.calibration = 0x5002; });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
    EXPECT_TRUE(contains(device->problem(), "inkwell")) << device->problem();
    EXPECT_TRUE(stays_at_zero(*device));
    // The stylus goes into the well: the driver now wants to be told to take that pose.
    with([](auto& hd) { hd.calibration = 0x5001; });
    EXPECT_TRUE(presses(*device));
    EXPECT_TRUE(has_no_problem(*device));
    EXPECT_EQ(called("update calibration 4"), 1);
}

TEST_F(OpenHaptics,
       a_calibration_that_the_driver_does_not_finish_stays_one_and_is_not_asked_often) {
    with([](auto& hd) {
        hd.calibration = 0x5001;
        hd.calibration_style = 2;
        hd.update_helps = false;
    });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
    EXPECT_TRUE(contains(device->problem(), "bringing its calibration up to date"));
    EXPECT_TRUE(stays_at_zero(*device));
    EXPECT_EQ(called("update calibration 2"), 1);
    EXPECT_TRUE(throughout(3s, [&] { return force().isZero(0); }));
    EXPECT_EQ(called("update calibration 2"), 4);  // once per second
}

TEST_F(OpenHaptics, encoders_are_zeroed_only_when_asked_to) {
    with([](auto& hd) {
        hd.calibration = 0x5001;
        hd.calibration_style = 1;
    });
    {
        const auto device = open();
        ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
        EXPECT_TRUE(contains(device->problem(), "reset=yes")) << device->problem();
        EXPECT_TRUE(stays_at_zero(*device));
    }
    const auto device = open(",reset=yes");
    EXPECT_TRUE(presses(*device));
    EXPECT_EQ(called("update calibration 1"), 1);
}

TEST_F(OpenHaptics, zeroing_encoders_that_cannot_be_zeroed_is_refused) {
    EXPECT_TRUE(contains(refusal(",reset=yes"), "cannot be zeroed"));
    EXPECT_FALSE(with([](auto& hd) { return hd.device_open; }));
}

TEST_F(OpenHaptics, a_fault_of_the_device_is_one_for_good_without_force) {
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& hd) { hd.next_error = 0x300; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(contains(device->problem(), "Device fault (0x300)")) << device->problem();
    EXPECT_TRUE(stays_at_zero(*device));
    EXPECT_EQ(device->read(0).status, DeviceStatus::fault);
}

TEST_F(OpenHaptics, warm_motors_get_no_force_until_they_have_cooled) {
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& hd) { hd.every_error = 0x200; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(contains(device->problem(), "Warm motors (0x200)")) << device->problem();
    EXPECT_TRUE(contains(device->problem(), "cooled")) << device->problem();
    EXPECT_TRUE(stays_at_zero(*device));
    with([](auto& hd) { hd.every_error = 0; });
    // A second after the last frame that reported it.
    EXPECT_TRUE(throughout(
        998ms, [&] { return device->read(0).status == DeviceStatus::fault && is_zero(); },
        [&] { device->write({Vec3(1, 2, 0)}, 0); }));
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_TRUE(presses(*device));
    EXPECT_TRUE(has_no_problem(*device));
}

TEST_F(OpenHaptics, an_error_that_ends_the_drivers_loop_ends_the_session) {
    for (const unsigned int ending : {0x304U, 0x500U, 0x501U}) {
        const auto device = open();
        ASSERT_TRUE(presses(*device));
        with([&](auto& hd) { hd.next_error = ending; });
        ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
        EXPECT_TRUE(contains(device->problem(), "servo loop has ended: start again"))
            << device->problem();
        EXPECT_TRUE(stays_at_zero(*device));
        with([](auto& hd) { hd.silent = false; });
        EXPECT_FALSE(within(2s, [&] { return device->read(0).status != DeviceStatus::lost; }));
    }
}

TEST_F(OpenHaptics, a_missing_licence_is_told_with_what_to_do) {
    with([](auto& hd) { hd.has_no_licence = true; });
    EXPECT_TRUE(contains(refusal(), "License Manager"));
    with([](auto& hd) { hd.has_no_licence = false; });
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& hd) { hd.next_error = 0x600; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(contains(device->problem(), "License Manager")) << device->problem();
    EXPECT_TRUE(stays_at_zero(*device));
    EXPECT_FALSE(within(2s, [&] { return device->read(0).status != DeviceStatus::fault; }));
}

/// [N] rendered after this force has been asked for so long.
class OpenHapticsMotors : public OpenHaptics {
  protected:
    double after(std::chrono::milliseconds time, double newtons) {
        throughout(
            time, [] { return true; }, [&] { device_->write({Vec3(0, newtons, 0)}, 0); });
        return force().norm();
    }
    std::unique_ptr<Device> device_;
};

TEST_F(OpenHapticsMotors, that_are_warm_are_asked_for_less_until_the_continuous_force_is_left) {
    device_ = open();
    for (const auto& [temperature, newtons] : {std::pair(0.5, 3.3),
                                               {0.6, 0.5 * (3.3 + 0.88)},
                                               {0.9, 0.88},
                                               {0.1, 3.3},
                                               {std::nan(""), 0.88}}) {
        with([warm = temperature](auto& hd) { hd.temperature = warm; });
        EXPECT_NEAR(after(150ms, 3.3), newtons, 1e-9);
        EXPECT_EQ(contains(device_->problem(), "motors are warm"), newtons < 3.3);
        EXPECT_EQ(device_->read(0).status, DeviceStatus::ready);
    }
}

TEST_F(OpenHapticsMotors, whose_temperature_was_lost_to_an_error_are_asked_again) {
    with([](auto& hd) { hd.temperature_error = 0x201; });
    device_ = open();
    after(150ms, 3.3);
    EXPECT_EQ(device_->read(0).status, DeviceStatus::fault);
    EXPECT_EQ(force().norm(), 0);
    with([](auto& hd) {
        hd.temperature_error = 0;
        hd.temperature = 0.9;
    });
    EXPECT_NEAR(after(1500ms, 3.3), 0.88, 1e-9);
    EXPECT_EQ(device_->read(0).status, DeviceStatus::ready);
}

TEST_F(OpenHapticsMotors, whose_temperature_no_driver_tells_are_left_to_the_estimate_of_the_servo) {
    with([](auto& hd) { hd.temperature = -1; });
    device_ = open();
    EXPECT_EQ(device_->info().limits.continuous_force, 0.88);
    EXPECT_NEAR(after(10s, 3.3), 3.3, 1e-9);
    EXPECT_EQ(device_->read(0).status, DeviceStatus::ready);
    with([](auto& hd) { hd.continuous_force = 100; });
    device_.reset();
    device_ = open();
    EXPECT_DOUBLE_EQ(device_->info().limits.continuous_force, 3.3 / 6);
}

TEST_F(OpenHaptics, an_error_of_which_the_driver_knows_no_words_is_told_by_its_number) {
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    with([](auto& hd) { hd.every_error = 0x201; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(contains(device->problem(), "error (0x201): force is off")) << device->problem();
}

TEST_F(OpenHaptics, a_position_that_the_driver_does_not_give_is_none) {
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& hd) { hd.no_position = true; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(stays_at_zero(*device));
}

TEST_F(OpenHaptics, a_servo_loop_that_stands_still_is_stale_and_can_be_closed) {
    auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    with([](auto& hd) { hd.silent = true; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::stale));
    EXPECT_TRUE(contains(device->problem(), "stands still")) << device->problem();
    with([](auto& hd) { hd.silent = false; });
    EXPECT_TRUE(presses(*device));
    with([](auto& hd) { hd.silent = true; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::stale));
    const std::int64_t then = support::virtual_now();
    device.reset();  // waits half a second for a last frame
    EXPECT_EQ(support::passed_since(then), 500ms);
    const auto calls = with([](auto& hd) { return hd.calls; });
    EXPECT_EQ(calls.back(), "disable device");
    EXPECT_TRUE(force().isZero(0));
}

INSTANTIATE_TYPED_TEST_SUITE_P(OpenHaptics, Vendor, OpenHaptics);
INSTANTIATE_TYPED_TEST_SUITE_P(Paced, ThreadOf, OpenHaptics);

}  // namespace
}  // namespace palpate::devices
