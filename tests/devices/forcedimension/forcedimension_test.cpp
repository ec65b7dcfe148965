// The device `forcedimension` against stand-ins for the vendor's libraries.
#include "devices/forcedimension/forcedimension_fixture.hpp"

#include <limits>

#include "devices/vendor_cases.hpp"

namespace palpate::devices {
namespace {

TEST_F(ForceDimension, looking_for_it_counts_the_devices_and_opens_none) {
    with([](auto& dhd) { dhd.count = 2; });
    const DeviceFinding finding = forcedimension::find(MOCK_DRD);
    EXPECT_TRUE(finding.found) << finding.missing;
    EXPECT_TRUE(contains(finding.what, "2 devices; Force Dimension SDK 3.17.5")) << finding.what;
    with([](auto& dhd) { dhd.count = 0; });
    const DeviceFinding nothing = forcedimension::find(MOCK_DRD);
    EXPECT_FALSE(nothing.found);
    EXPECT_TRUE(contains(nothing.missing, "connect it")) << nothing.missing;
    EXPECT_TRUE(with([](auto& dhd) { return dhd.calls.empty(); }));
}

TEST_F(ForceDimension, options_that_cannot_be_meant_are_refused) {
    const auto wrong = [&](const std::string& options) {
        return message_of<std::invalid_argument>([&] { open(options); });
    };
    EXPECT_TRUE(
        contains(wrong(",gripper=yes"), "use one of index, autoinit, centre, simulator, library"));
    EXPECT_TRUE(contains(wrong(",index=1.5"), "a whole number is needed"));
    EXPECT_TRUE(contains(wrong(",index=-1"), "a number from 0 to 100"));
    EXPECT_TRUE(contains(wrong(",autoinit=perhaps"), "use one of yes, no"));
}

TEST_F(ForceDimension, the_vendors_simulator_is_a_device_when_asked_for) {
    with([](auto& dhd) { dhd.count = 0; });
    EXPECT_TRUE(presses(*open(",simulator=yes")));
    EXPECT_TRUE(contains(refusal(), "no device (0 found)"));
}

TEST_F(ForceDimension, a_device_that_is_not_there_or_does_not_open_is_told_with_what_to_do) {
    EXPECT_TRUE(contains(refusal(",index=3"), "no device with index=3 (1 found)"));
    with([](auto& dhd) { dhd.refuses_open = true; });
    EXPECT_TRUE(contains(refusal(), "cannot open device 0: device already in use"));
    with([](auto& dhd) { dhd.count = 0; });
    EXPECT_TRUE(contains(refusal(), "no device (0 found): connect it"));
}

TEST_F(ForceDimension, each_model_has_its_own_limits) {
    const DeviceInfo omega = open()->info();
    EXPECT_EQ(omega.name, "forcedimension");
    EXPECT_EQ(omega.model, "mock.3, serial number 4711");
    EXPECT_EQ(omega.limits.maximum_force, 12);
    EXPECT_EQ(omega.limits.rate, 1000);
    EXPECT_FALSE(omega.has_orientation);
    EXPECT_EQ(with([](auto& dhd) { return dhd.wrong_id; }), 0);
    with([](auto& dhd) { dhd.type = 60; });
    const DeviceInfo falcon = open("", 8000)->info();
    EXPECT_EQ(falcon.limits.maximum_force, 8);
    EXPECT_EQ(falcon.limits.rate, 4000);
    EXPECT_EQ(falcon.workspace_high, Vec3(40, 40, 40));
    EXPECT_EQ(falcon.buttons, 4);
    with([](auto& dhd) { dhd.type = 63; });
    EXPECT_EQ(open()->info().limits.maximum_force, 20);
}

TEST_F(ForceDimension, the_middle_of_a_sigma_lies_beside_its_origin) {
    for (const auto& [type, right] : {std::pair(104, -20), {105, 20}, {106, -20}, {107, 20}}) {
        with([number = type](auto& dhd) { dhd.type = number; });
        const DeviceInfo info = open()->info();
        EXPECT_EQ(0.5 * (info.workspace_low + info.workspace_high), Vec3(right, 0, 10)) << type;
        EXPECT_EQ(info.workspace_high - info.workspace_low, Vec3(130, 130, 130)) << type;
    }
}

TEST_F(ForceDimension, a_library_that_tells_more_of_its_status_than_is_known_does_no_harm) {
    with([](auto& dhd) { dhd.status_count = 32; });
    const auto device = open();
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
}

TEST_F(ForceDimension, a_model_that_nobody_has_listed_is_what_its_library_says) {
    with([](auto& dhd) { dhd.type = 4242; });
    const DeviceInfo bare = open()->info();
    EXPECT_EQ(bare.limits.maximum_force, 8);
    EXPECT_FALSE(bare.has_orientation);
    with([](auto& dhd) {
        dhd.wrist = dhd.gripper = dhd.active_wrist = true;
        dhd.limit = 15;
        dhd.max_force = -1;
    });
    const DeviceInfo full = open()->info();
    EXPECT_EQ(full.limits.maximum_force, 15);
    EXPECT_TRUE(full.has_orientation);
    EXPECT_EQ(full.limits.maximum_torque, 150);
    EXPECT_EQ(full.buttons, 1);
    // For a listed device, the library's limit counts if it is lower.
    with([](auto& dhd) { dhd.type = 33, dhd.limit = 15, dhd.max_force = -1; });
    EXPECT_EQ(open()->info().limits.maximum_force, 12);
    with([](auto& dhd) { dhd.limit = 5, dhd.max_force = -1; });
    EXPECT_EQ(open()->info().limits.maximum_force, 5);
}

TEST_F(ForceDimension, a_gripper_is_a_button_while_the_device_is_open) {
    with([](auto& dhd) {
        dhd.type = 35;
        dhd.buttons = 1;
    });
    {
        const auto device = open();
        EXPECT_EQ(device->info().buttons, 1);
        ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
        EXPECT_EQ(device->read(0).buttons, 1U);
    }
    EXPECT_FALSE(with([](auto& dhd) { return dhd.emulates_button; }));
    with([](auto& dhd) { dhd.refuses_emulation = true; });
    EXPECT_EQ(open()->info().buttons, 0);
}

TEST_F(ForceDimension, the_opening_of_a_gripper_comes_with_each_reading) {
    EXPECT_FALSE(open()->info().has_gripper);
    with([](auto& dhd) { dhd.type = 35; });
    const auto device = open();
    EXPECT_TRUE(device->info().has_gripper);
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_EQ(device->read(0).opening, 0.5);
    EXPECT_FALSE(grasps(device->read(0)));
    with([](auto& dhd) { dhd.opening = 0.02; });
    step();
    EXPECT_TRUE(grasps(device->read(0)));
    with([](auto& dhd) { dhd.opening = -0.4; });  // of a left-handed device
    step();
    EXPECT_EQ(device->read(0).opening, 0.4);
    with([](auto& dhd) { dhd.opening = std::numeric_limits<double>::quiet_NaN(); });
    step();
    EXPECT_EQ(device->read(0).opening, std::nullopt);
    EXPECT_EQ(device->read(0).status, DeviceStatus::ready);
    with([](auto& dhd) { dhd.opening_error = 2; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::lost));
}

TEST_F(ForceDimension, position_and_buttons_come_in_mm_in_our_axes) {
    with([](auto& dhd) {
        dhd.position = {0.01, 0.02, -0.03};
        dhd.buttons = 5;
    });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    const DeviceReading reading = device->read(0);
    EXPECT_LE((reading.position - Vec3(20, -30, 10)).norm(), 1e-12);
    EXPECT_EQ(reading.orientation, Mat3(Mat3::Identity()));
    EXPECT_EQ(reading.buttons, 5U);
    EXPECT_TRUE(has_no_problem(*device));
}

TEST_F(ForceDimension, a_wrist_turns_in_our_axes) {
    with([](auto& dhd) {
        dhd.type = 34;
        // A quarter turn about the library's z, which is our y.
        const double turn[3][3] = {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
        std::copy(&turn[0][0], &turn[0][0] + 9, &dhd.frame[0][0]);
    });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_TRUE(device->info().has_orientation);
    Mat3 about_y;
    about_y << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    EXPECT_LE((device->read(0).orientation - about_y).norm(), 1e-12);
}

TEST_F(ForceDimension, a_force_to_the_right_up_and_towards_the_person_is_one_along_y_z_and_x) {
    const auto device = open();
    EXPECT_TRUE(presses(*device, Vec3(1, 2, 3)));
    EXPECT_EQ(with([](auto& dhd) { return dhd.force; }), (std::array<double, 3>{3, 1, 2}));
    EXPECT_EQ(with([](auto& dhd) { return dhd.wrong_id; }), 0);
}

TEST_F(ForceDimension, a_force_beyond_the_devices_own_is_cut_to_it) {
    const auto device = open();
    EXPECT_TRUE(is_given(*device, {Vec3(30, 0, 40)}, {Vec3(0.6, 0, 0.8) * 12}, felt));
    EXPECT_LE(with([](auto& dhd) { return dhd.largest_force; }), 12 + 1e-12);
    EXPECT_EQ(with([](auto& dhd) { return dhd.max_force; }), 12);
}

TEST_F(ForceDimension, the_time_guard_and_a_saturated_motor_are_no_errors) {
    with([](auto& dhd) {
        dhd.position_result = 1;
        dhd.force_result = 2;
    });
    const auto device = open();
    EXPECT_TRUE(presses(*device));
    EXPECT_TRUE(has_no_problem(*device));
}

TEST_F(ForceDimension, it_is_switched_on_and_off_in_order_and_its_last_force_is_zero) {
    auto device = open();
    ASSERT_TRUE(presses(*device));
    EXPECT_EQ(with([](auto& dhd) { return dhd.watchdog; }), 240);
    EXPECT_EQ(with([](auto& dhd) { return dhd.gravity; }), 1);
    device.reset();
    const std::vector<std::string> expected{"drd open",     "max force", "brakes",
                                            "enable force", "gravity",   "watchdog",
                                            "watchdog",     "stop",      "drd close"};
    EXPECT_EQ(with([](auto& dhd) { return dhd.calls; }), expected);
    EXPECT_EQ(with([](auto& dhd) { return dhd.force_at_stop; }), (std::array<double, 3>{}));
    EXPECT_EQ(with([](auto& dhd) { return dhd.watchdog; }), 17);  // as it was
    EXPECT_FALSE(with([](auto& dhd) { return dhd.is_expert; }));
    EXPECT_EQ(with([](auto& dhd) { return dhd.wrong_id; }), 0);
    EXPECT_NO_THROW(open());
}

TEST_F(ForceDimension, works_with_the_smaller_library_alone) {
    use(MOCK_DHD);
    auto device = open();
    EXPECT_TRUE(presses(*device));
    device.reset();
    EXPECT_EQ(called("dhd open"), 1);
    EXPECT_EQ(called("dhd close"), 1);
    EXPECT_TRUE(contains(refusal(",autoinit=yes"), "install libdrd"));
    EXPECT_FALSE(with([](auto& dhd) { return dhd.is_open; }));
    with([](auto& dhd) { dhd.initialised = false; });
    EXPECT_TRUE(becomes(*open(), DeviceStatus::uncalibrated));
}

TEST_F(ForceDimension, an_uninitialised_device_has_no_force_and_says_what_to_do) {
    with([](auto& dhd) { dhd.initialised = false; });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
    EXPECT_TRUE(says(*device, "calibration pit"));
    EXPECT_TRUE(says(*device, "autoinit=yes, which moves it"));
    EXPECT_TRUE(stays_at_zero(*device));
    EXPECT_EQ(called("initialise"), 0);
    EXPECT_EQ(called("enable force"), 0);
    with([](auto& dhd) { dhd.initialised = true; });  // by hand
    EXPECT_TRUE(presses(*device));
    EXPECT_TRUE(has_no_problem(*device));
}

TEST_F(ForceDimension, a_device_that_was_off_for_a_while_is_switched_on_again) {
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& dhd) {
        dhd.initialised = dhd.force_on = false;
        dhd.brakes = true;
    });
    ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
    with([](auto& dhd) { dhd.initialised = true; });
    EXPECT_TRUE(presses(*device));
}

TEST_F(ForceDimension, it_moves_by_itself_only_when_asked_to_and_says_so_meanwhile) {
    const auto device = open(",autoinit=yes");
    int told = 0;
    with([&](auto& dhd) {
        dhd.initialised = false;
        dhd.while_initialising = [&] {
            pass(5s);
            told += device->read(0).status == DeviceStatus::uncalibrated &&
                    contains(device->problem(), "keep your hands off");
        };
    });
    step();
    EXPECT_TRUE(presses(*device));
    EXPECT_TRUE(has_no_problem(*device));
    EXPECT_EQ(called("initialise"), 1);
    EXPECT_EQ(told, 1);
}

TEST_F(ForceDimension, one_that_is_initialised_does_not_move_even_when_asked_to) {
    const auto device = open(",autoinit=yes");
    EXPECT_TRUE(presses(*device));
    EXPECT_EQ(called("initialise"), 0);
}

TEST_F(ForceDimension, one_that_cannot_initialise_itself_says_why) {
    with([](auto& dhd) { dhd.initialised = dhd.initialises = false; });
    const auto device = open(",autoinit=yes");
    EXPECT_TRUE(says(*device, "it could not initialise itself (geometry error)"));
    EXPECT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
    EXPECT_TRUE(stays_at_zero(*device));
    EXPECT_EQ(called("initialise"), 1);  // it tries once
}

TEST_F(ForceDimension, a_device_whose_force_cannot_be_switched_on_is_no_ready_one) {
    with([](auto& dhd) { dhd.refuses_force = true; });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
    EXPECT_TRUE(says(*device, "undocumented error"));
    EXPECT_TRUE(stays_at_zero(*device));
    with([](auto& dhd) { dhd.refuses_force = false; });
    EXPECT_TRUE(presses(*device));
}

TEST_F(ForceDimension, an_error_of_reading_or_of_force_is_a_fault_in_the_librarys_words) {
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& dhd) { dhd.position_error = 8; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(says(*device, "the library reports: geometry error"));
    EXPECT_TRUE(stays_at_zero(*device));
    with([](auto& dhd) { dhd.position_error = 0; });
    ASSERT_TRUE(presses(*device));
    with([](auto& dhd) { dhd.force_error = 8; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::fault));
    with([](auto& dhd) { dhd.force_error = 0; });
    EXPECT_TRUE(presses(*device));
    with([](auto& dhd) { dhd.status_error = 2; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::lost));
    EXPECT_TRUE(stays_at_zero(*device));
}

TEST_F(ForceDimension, a_device_that_has_switched_its_force_off_is_a_fault_until_it_is_on_again) {
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& dhd) { dhd.force_off_cause = 1; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(says(*device, "press its force button"));
    with([](auto& dhd) { dhd.force_off_cause = 2; });
    EXPECT_TRUE(says(*device, "moved faster"));
    EXPECT_EQ(called("enable force"), 1);  // that is for the person to do
    with([](auto& dhd) { dhd.force_off_cause = 0; });
    EXPECT_TRUE(presses(*device));
}

TEST_F(ForceDimension, the_devices_watchdog_is_answered_by_switching_the_force_on_again) {
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& dhd) { dhd.force_off_cause = 3; });
    EXPECT_TRUE(within(soon, [&] { return called("enable force") == 2; }));
    EXPECT_TRUE(presses(*device));
}

TEST_F(ForceDimension, a_device_that_never_tells_of_its_force_is_ready_all_the_same) {
    with([](auto& dhd) { dhd.tells_of_force = false; });
    const auto device = open();
    EXPECT_TRUE(presses(*device));
    EXPECT_TRUE(has_no_problem(*device));
}

TEST_F(ForceDimension, that_is_slow_is_said_to_drop_its_force_only_if_it_took_the_watchdog) {
    for (const bool refuses : {false, true}) {
        with([&](auto& dhd) {
            dhd.refuses_watchdog = refuses;
            dhd.while_reading = [] { pass(50ms); };
        });
        const auto device = open();
        ASSERT_TRUE(becomes(*device, DeviceStatus::stale));
        EXPECT_TRUE(says(*device, "takes too long"));
        EXPECT_TRUE(says(*device, refuses ? "it may still hold the last force"
                                          : "the device drops the last force by itself"));
        EXPECT_EQ(with([](auto& dhd) { return dhd.watchdog; }), refuses ? 17 : 240);
    }
}

INSTANTIATE_TYPED_TEST_SUITE_P(ForceDimension, Vendor, ForceDimension);
INSTANTIATE_TYPED_TEST_SUITE_P(Paced, ThreadOf, ForceDimension);

class PacedForceDimension : public ForceDimension {};

TEST_F(PacedForceDimension, its_thread_steps_at_4_khz_at_most) {
    const auto loops = [&] { return with([](auto& dhd) { return dhd.loops; }); };
    const auto begun = std::chrono::steady_clock::now();
    const auto device = open_device(choice(), any_scene());
    EXPECT_TRUE(support::comes_true([&] { return loops() > 100; }));
    const auto seen = static_cast<double>(loops());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    EXPECT_LE(seen, 4000 * took.count() + 2);
}

}  // namespace
}  // namespace palpate::devices
