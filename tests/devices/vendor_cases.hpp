// Cases that every backend of a vendor's library has to pass. A test program instantiates the
// suites with its fixture.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "devices/blocked_driver.hpp"
#include "devices/claim.hpp"
#include "devices/vendor_device.hpp"
#include "support/eventually.hpp"

namespace palpate::devices {

/// `Backend` is a VendorDevice with the members that the cases use.
template <class Backend>
class Vendor : public Backend {};
TYPED_TEST_SUITE_P(Vendor);

TYPED_TEST_P(Vendor, whose_library_is_missing_is_told_with_what_to_install) {
    this->use_nothing("/nowhere/library.so");
    const std::string message =
        message_of<DeviceError>([&] { open_device(this->choice(), any_scene()); });
    EXPECT_TRUE(message.starts_with("device " + this->choice().name + ": ")) << message;
    const DeviceFinding finding = TypeParam::find("/nowhere/library.so");
    EXPECT_FALSE(finding.found);
    for (const char* part : {"/nowhere/library.so", TypeParam::install, "library=PATH"}) {
        EXPECT_TRUE(contains(message, part)) << message;
        EXPECT_TRUE(contains(finding.missing, part)) << finding.missing;
    }
}

TYPED_TEST_P(Vendor, whose_library_lacks_a_function_is_refused_by_its_name) {
    this->use(TypeParam::lacking);
    const std::string message = this->refusal();
    EXPECT_TRUE(contains(message, TypeParam::lacks)) << message;
    EXPECT_FALSE(TypeParam::find(TypeParam::lacking).found);
}

TYPED_TEST_P(Vendor, is_looked_for_without_opening_it) {
    EXPECT_TRUE(TypeParam::find(TypeParam::library).found);
    EXPECT_FALSE(this->is_open());
    const DeviceFinding usual = TypeParam::find("");
    EXPECT_EQ(usual.name, this->choice().name);
    EXPECT_NE(usual.found, usual.what.empty());
    EXPECT_EQ(usual.found, usual.missing.empty());
    EXPECT_FALSE(contains(usual.missing, "has no function")) << usual.missing;
}

TYPED_TEST_P(Vendor, whose_opening_is_stopped_is_left_alone_and_closed_at_its_end) {
    support::expect_a_stopped_opening_is_left_alone(
        [&](const OnProgress& progress) { return this->open("", 1000, progress); },
        [&](const auto& block) { this->with([&](auto& state) { state.while_opening = block; }); });
    EXPECT_FALSE(this->is_open());
}

TYPED_TEST_P(Vendor, serves_one_hand_which_lets_go_of_it_before_it_is_opened_again) {
    const int hands[2] = {};
    std::unique_ptr<Device> held;
    const auto open_by = [&](const int& hand) {
        const OpenedBy opened_by(&hand, [&] { held.reset(); });
        held = this->open();
    };
    open_by(hands[0]);
    EXPECT_THROW(open_by(hands[1]), DeviceError);
    EXPECT_TRUE(contains(this->refusal(), "serves another hand"));
    {
        const OpenedBy cannot_close(&hands[0], {});
        EXPECT_THROW(this->open(), DeviceError);
    }
    ASSERT_TRUE(held);
    EXPECT_TRUE(this->becomes(*held, DeviceStatus::ready));
    open_by(hands[0]);
    EXPECT_TRUE(this->becomes(*held, DeviceStatus::ready));
    held.reset();
    EXPECT_NO_THROW(this->open());
}

TYPED_TEST_P(Vendor, gives_a_force_in_newtons_in_the_axes_it_was_written_in) {
    const auto device = this->open();
    for (const Vec3& newtons : {Vec3(0.5, -1, 2), Vec3(-2, 0.25, -0.125), Vec3(0, 0, 1)}) {
        EXPECT_TRUE(this->presses(*device, newtons)) << this->force().transpose();
    }
    EXPECT_TRUE(this->has_no_problem(*device));
}

TYPED_TEST_P(Vendor, gives_no_force_for_one_that_is_no_number) {
    const auto device = this->open();
    ASSERT_TRUE(this->presses(*device));
    device->write({Vec3(1, std::numeric_limits<double>::quiet_NaN(), 0)}, 0);
    this->step();
    EXPECT_TRUE(this->is_zero());
}

TYPED_TEST_P(Vendor, loses_its_force_when_the_servo_falls_silent) {
    const auto device = this->open();
    ASSERT_TRUE(this->presses(*device));
    EXPECT_TRUE(this->goes_to_zero_in_silence());
    EXPECT_TRUE(this->becomes(*device, DeviceStatus::ready));
    EXPECT_TRUE(this->presses(*device));
}

TYPED_TEST_P(Vendor, loses_its_force_for_good_when_it_is_stopped) {
    auto device = this->open();
    ASSERT_TRUE(this->presses(*device));
    device->stop();
    EXPECT_TRUE(device->is_stopping());
    EXPECT_TRUE(this->stays_at_zero(*device));
    EXPECT_FALSE(device->is_stopping());
    EXPECT_TRUE(this->becomes(*device, DeviceStatus::ready));
    device.reset();
    device = this->open();
    EXPECT_TRUE(this->presses(*device));
}

TYPED_TEST_P(Vendor, that_is_closed_has_no_force_and_can_be_opened_again) {
    for (int i = 0; i < 3; ++i) {
        auto device = this->open();
        EXPECT_TRUE(this->presses(*device, Vec3(1, i, 0)));
        device.reset();
        EXPECT_TRUE(this->is_zero());
        EXPECT_FALSE(this->is_open());
    }
}

TYPED_TEST_P(Vendor, whose_connection_breaks_in_contact_is_lost_and_has_no_force) {
    const auto device = this->open();
    ASSERT_TRUE(this->presses(*device));
    this->break_connection(true);
    ASSERT_TRUE(this->becomes(*device, DeviceStatus::lost));
    EXPECT_TRUE(this->says(*device, "check cable"));
    EXPECT_TRUE(this->says(*device, TypeParam::words_of_break)) << device->problem();
    EXPECT_TRUE(this->stays_at_zero(*device));
    this->break_connection(false);
    EXPECT_EQ(this->becomes(*device, DeviceStatus::ready, 1100ms), TypeParam::comes_back);
    EXPECT_EQ(this->presses(*device), TypeParam::comes_back);
    EXPECT_EQ(this->has_no_problem(*device), TypeParam::comes_back);
}

REGISTER_TYPED_TEST_SUITE_P(Vendor, whose_library_is_missing_is_told_with_what_to_install,
                            whose_library_lacks_a_function_is_refused_by_its_name,
                            is_looked_for_without_opening_it,
                            whose_opening_is_stopped_is_left_alone_and_closed_at_its_end,
                            serves_one_hand_which_lets_go_of_it_before_it_is_opened_again,
                            gives_a_force_in_newtons_in_the_axes_it_was_written_in,
                            gives_no_force_for_one_that_is_no_number,
                            loses_its_force_when_the_servo_falls_silent,
                            loses_its_force_for_good_when_it_is_stopped,
                            that_is_closed_has_no_force_and_can_be_opened_again,
                            whose_connection_breaks_in_contact_is_lost_and_has_no_force);

/// The backend's thread, or the driver's, at its real pace. To be instantiated as `Paced`.
template <class Backend>
class ThreadOf : public Backend {};
TYPED_TEST_SUITE_P(ThreadOf);

TYPED_TEST_P(ThreadOf, a_vendors_device_presses_until_it_is_closed) {
    this->let_time_pass_by_itself();
    auto device = open_device(this->choice(), any_scene());
    const Wrench push{Vec3(1, 2, 0)};
    EXPECT_TRUE(support::comes_true([&] {
        device->write(push, 0);
        return this->gives(push);
    }));
    EXPECT_TRUE(support::comes_true([&] { return this->is_zero(); }));  // the servo is silent
    EXPECT_TRUE(support::comes_true([&] { return device->read(0).status == DeviceStatus::ready; }));
    device.reset();
    EXPECT_TRUE(this->is_zero());
    EXPECT_FALSE(this->is_open());
}

REGISTER_TYPED_TEST_SUITE_P(ThreadOf, a_vendors_device_presses_until_it_is_closed);

}  // namespace palpate::devices
