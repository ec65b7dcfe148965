// The device against a service that behaves.
#include "devices/haply/haply_fixture.hpp"

namespace palpate::devices {
namespace {

TEST_F(HaplyTest, one_device_does_not_serve_two_hands) {
    {
        const auto first = open();
        EXPECT_NE(refusal(std::string("device=") + id).find("serves another hand"),
                  std::string::npos);
    }
    EXPECT_EQ(refusal(std::string("device=") + id), "");
}

TEST_F(HaplyTest, positions_are_mm_in_our_axes) {
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    const Vec3 expected(100, 300, 200);
    EXPECT_LT((device->read(0).position - expected).norm(), 1e-9);
    EXPECT_EQ(device->problem(), "");
}

TEST_F(HaplyTest, axes_can_be_chosen) {
    const auto device = open("axes=xyz");
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_LT((device->read(0).position - Vec3(100, -200, 300)).norm(), 1e-9);
    EXPECT_EQ(device->info().workspace_low, Vec3(-300, -299, -118));
    EXPECT_TRUE(within(
        felt, [&] { return service.forces().back() == push; }, [&] { device->write({push}, 0); }));
}

TEST_F(HaplyTest, says_what_it_is) {
    const auto device = open();
    const DeviceInfo info = device->info();
    EXPECT_EQ(info.name, "haply");
    EXPECT_EQ(info.model, "Inverse3 049D, firmware 7.4");
    EXPECT_EQ(info.limits.maximum_force, 10);
    EXPECT_EQ(info.limits.rate, 1000);
    EXPECT_EQ(info.stiffness, 1);
    EXPECT_EQ(info.workspace_low, Vec3(-300, -118, -163));
    EXPECT_EQ(info.workspace_high, Vec3(286, 378, 299));
    EXPECT_EQ(info.buttons, 3);  // of a grip that may come
    EXPECT_FALSE(info.has_orientation);
    EXPECT_TRUE(info.renders_force);
}

TEST_F(HaplyTest, a_position_that_is_left_out_has_not_changed) {
    service.greet(snapshot({whole_device(id, Vec3(0.05, 0, 0))}));
    service.answer(R"({"inverse3":[{"device_id":"049D"}]})");
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_EQ(device->read(0).position, Vec3(50, 0, 0));
}

TEST_F(HaplyTest, forces_arrive_as_written_and_nothing_else_does) {
    const auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    EXPECT_NE(service.last_message().find("\"values\""), std::string::npos);
    for (const Vec3& force : service.forces()) {
        EXPECT_TRUE(force == push_arrives || force.isZero(0)) << force.transpose();
    }
}

TEST_F(HaplyTest, the_other_spelling_of_the_force_is_an_option) {
    const auto device = open("force_key=vector");
    ASSERT_TRUE(is_pressed(*device));
    EXPECT_NE(service.last_message().find("\"vector\""), std::string::npos);
    EXPECT_EQ(service.last_message().find("\"values\""), std::string::npos);
}

TEST_F(HaplyTest, no_force_beyond_what_the_device_can_take) {
    const auto device = open();
    ASSERT_TRUE(within(
        felt, [&] { return service.forces().back()[0] > 9; },
        [&] { device->write({Vec3(30, 0, 0)}, 0); }));
    for (const Vec3& force : service.forces()) EXPECT_LE(force.norm(), 10 + 1e-12);
}

TEST_F(HaplyTest, the_grip_gives_orientation_and_buttons) {
    // 90 degrees about the service's z, which is up: our y.
    service.answer(with_grip(moved(id, Vec3(0, 0, 0)),
                             R"("device_id":"G","state":{"orientation":{"w":0.70710678118654757,
                                "x":0,"y":0,"z":0.70710678118654757},
                                "buttons":{"a":true,"b":false,"c":true}})"));
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    const DeviceReading reading = device->read(0);
    EXPECT_EQ(reading.buttons, 5U);
    EXPECT_LT((reading.orientation * Vec3(0, 0, 1) - Vec3(1, 0, 0)).norm(), 1e-12);
    EXPECT_TRUE(device->info().has_orientation);
}

TEST_F(HaplyTest, the_device_asked_for_is_the_one_that_moves) {
    service.greet(snapshot({whole_device("A", Vec3(1, 0, 0)), whole_device("B", Vec3(2, 0, 0))}));
    service.answer(
        R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":1}}},
                        {"device_id":"B","state":{"cursor_position":{"x":2}}}]})");
    const auto device = open("device=B");
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_EQ(device->read(0).position, Vec3(2000, 0, 0));
    EXPECT_NE(service.last_message().find("\"device_id\":\"B\""), std::string::npos);
}

TEST_F(HaplyTest, the_first_device_is_taken_and_one_that_is_not_there_is_not) {
    service.greet(snapshot({whole_device("A"), whole_device("B")}));
    EXPECT_NE(refusal("device=C").find("no device C; attached: A, B"), std::string::npos);
    const auto device = open();
    EXPECT_EQ(device->info().model, "Inverse3 A, firmware 7.4");
}

TEST_F(HaplyTest, is_not_ready_before_it_is_calibrated) {
    service.greet(snapshot({whole_device(id, Vec3(0, 0, 0), status(false))}));
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
    EXPECT_TRUE(says(*device, "calibrate"));
    EXPECT_TRUE(nothing_is_felt(*device));
    service.answer(snapshot({whole_device(id, Vec3(0, 0, 0), status(true, false))}));
    ASSERT_TRUE(becomes(*device, DeviceStatus::starting));
    EXPECT_TRUE(nothing_is_felt(*device));
    service.answer(snapshot({whole_device(id)}));
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_TRUE(is_pressed(*device));
}

TEST_F(HaplyTest, calibration_can_be_taken_for_granted) {
    service.greet(snapshot({whole_device(id, Vec3(0.1, -0.2, 0.3), status(false))}));
    const auto device = open("calibrated=assume");
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_NE(refusal("calibrated=maybe"), "");
}

TEST_F(HaplyTest, the_force_ends_with_the_servo) {
    const auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    const std::int64_t written = virtual_now();  // or up to a step before
    EXPECT_TRUE(within(21ms, [&] { return service.forces().back().isZero(0); }));
    EXPECT_GE(passed_since(written), 19ms);
}

TEST_F(HaplyTest, a_stop_is_for_good) {
    const auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    device->stop();
    EXPECT_TRUE(device->is_stopping());
    EXPECT_TRUE(nothing_is_felt(*device));
    EXPECT_FALSE(device->is_stopping());
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
}

TEST_F(HaplyTest, closing_sends_no_force_and_says_goodbye) {
    auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    device.reset();
    EXPECT_TRUE(service.closed_politely());
    EXPECT_TRUE(service.forces().back().isZero(0));
}

TEST_F(HaplyTest, asks_no_more_than_four_thousand_times_a_second) {
    const auto device = open();
    EXPECT_TRUE(throughout(1s, [] { return true; }));
    EXPECT_GE(service.messages(), 3990U);
    EXPECT_LE(service.messages(), 4001U);
}

TEST_F(HaplyTest, what_opening_needs_is_said) {
    EXPECT_NE(refusal("axes=xzy").find("axes=xzy"), std::string::npos);
    EXPECT_NE(refusal("force_key=force").find("values, vector"), std::string::npos);
    EXPECT_NE(refusal("timeout=0").find("0.1 to 5"), std::string::npos);
    EXPECT_NE(refusal("colour=red").find("no option 'colour'"), std::string::npos);
    EXPECT_THROW(open_device(parse_device("haply:port=1.5"), any_scene()), std::invalid_argument);

    const std::int64_t begun = virtual_now();
    service.greet(snapshot({}));
    EXPECT_NE(refusal().find("no Inverse3 attached"), std::string::npos);
    EXPECT_EQ(passed_since(begun), 0ns);
    service.greet("hello");
    EXPECT_NE(refusal().find("does not say what is attached"), std::string::npos);
    EXPECT_EQ(passed_since(begun), 5s) << "a busy machine may be late";
}

TEST_F(HaplyTest, a_service_that_is_just_starting_gets_a_second) {
    service.refuse(true);
    const std::int64_t begun = virtual_now();
    const std::string said = refusal();
    EXPECT_NE(said.find("nothing to talk to at 127.0.0.1:4711"), std::string::npos) << said;
    EXPECT_NE(said.find("haply-inverse-service"), std::string::npos) << said;
    EXPECT_EQ(passed_since(begun), 1s);
    EXPECT_EQ(service.attempts(), 11);
}

TEST_F(HaplyTest, a_host_that_is_not_there_is_said_with_what_to_give) {
    try {
        open_device(parse_device("haply:host=.."), any_scene());
        ADD_FAILURE() << "no host has this name";
    } catch (const DeviceError& error) {
        EXPECT_NE(std::string(error.what()).find("no host '..'"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate::devices
