// The Inverse Service's messages and our commands, as text.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "devices/haply/messages.hpp"
#include "devices/haply/protocol.hpp"
#include "support/allocation_counter.hpp"

namespace palpate::devices::haply {
namespace {

using namespace palpate::support;

ServiceState after(const std::vector<std::string>& messages) {
    ServiceState state;
    for (const std::string& message : messages) take_message(state, message);
    return state;
}

TEST(HaplyProtocol, the_first_message_tells_all) {
    ServiceState state;
    ASSERT_EQ(take_message(state, snapshot({whole_device("049D", Vec3(0.1, -0.2, 0.3))})),
              News::state);
    EXPECT_EQ(state.device_id, "049D");
    EXPECT_EQ(state.model, "Inverse3 049D, firmware 7.4");
    ASSERT_TRUE(state.position);
    EXPECT_EQ(*state.position, Vec3(0.1, -0.2, 0.3));
    EXPECT_EQ(status_of(state), DeviceStatus::ready);
    EXPECT_EQ(problem_of(state), "");
}

TEST(HaplyProtocol, what_a_later_message_leaves_out_stays) {
    ServiceState state = after({snapshot({whole_device("049D", Vec3(0.1, -0.2, 0.3))})});
    ASSERT_EQ(take_message(state, moved("049D", Vec3(0.5, 0, 0))), News::state);
    EXPECT_EQ(*state.position, Vec3(0.5, 0, 0));
    EXPECT_EQ(status_of(state), DeviceStatus::ready);
    EXPECT_EQ(state.model, "Inverse3 049D, firmware 7.4");

    const std::string only_y =
        R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"y":1}}}]})";
    ASSERT_EQ(take_message(state, only_y), News::state);
    EXPECT_EQ(*state.position, Vec3(0.5, 1, 0));

    ASSERT_EQ(take_message(state, R"({"inverse3":[{"device_id":"049D"}]})"), News::state);
    EXPECT_EQ(*state.position, Vec3(0.5, 1, 0));
}

TEST(HaplyProtocol, an_entry_without_an_id_is_known_by_its_place) {
    ServiceState state;
    state.wanted = "B";
    take_message(state, snapshot({whole_device("A"), whole_device("B")}));
    const std::string nameless =
        R"({"inverse3":[{"state":{"cursor_position":{"x":1,"y":1,"z":1}}},
                        {"state":{"cursor_position":{"x":2,"y":2,"z":2}}}]})";
    ASSERT_EQ(take_message(state, nameless), News::state);
    EXPECT_EQ(*state.position, Vec3(2, 2, 2));
    // The other device alone, named, is not ours.
    EXPECT_EQ(take_message(state, moved("A", Vec3(3, 3, 3))), News::gone);
    EXPECT_EQ(*state.position, Vec3(2, 2, 2));
}

TEST(HaplyProtocol, the_first_device_or_the_one_asked_for_is_taken) {
    const std::string both = snapshot({whole_device("A", Vec3(1, 0, 0)), whole_device("B")});
    EXPECT_EQ(after({both}).device_id, "A");
    // Ours is found wherever it is in the list.
    EXPECT_EQ(
        *after({both, snapshot({whole_device("B"), whole_device("A", Vec3(2, 0, 0))})}).position,
        Vec3(2, 0, 0));
    ServiceState state;
    state.wanted = "C";
    EXPECT_EQ(take_message(state, both), News::gone);
    EXPECT_EQ(state.device_id, "");
    EXPECT_EQ(state.attached, "A, B");
}

TEST(HaplyProtocol, a_message_about_other_things_is_no_news) {
    ServiceState state = after({snapshot({whole_device("A")})});
    EXPECT_EQ(take_message(state, R"({"session_id":7})"), News::none);
    EXPECT_EQ(take_message(state, "{}"), News::none);
    EXPECT_EQ(take_message(state, R"({"inverse3":[]})"), News::gone);
}

TEST(HaplyProtocol, broken_positions_are_refused_and_the_last_one_stays) {
    ServiceState state = after({snapshot({whole_device("A", Vec3(0.1, 0.2, 0.3))})});
    for (const char* broken :
         {R"({"x":"NaN","y":0,"z":0})", R"({"x":null,"y":0,"z":0})", R"({"x":10.1,"y":0,"z":0})",
          R"({"x":-1e30,"y":0,"z":0})", R"({"x":8,"y":8,"z":8})", R"({"x":[0],"y":0,"z":0})",
          R"([0,0,0])", "null", "\"near\"", R"({"x":true,"y":0,"z":0})"}) {
        const std::string message = R"({"inverse3":[{"device_id":"A","state":{"cursor_position":)" +
                                    std::string(broken) + "}}]}";
        EXPECT_EQ(take_message(state, message), News::refused) << broken;
        EXPECT_FALSE(state.error.empty()) << broken;
        EXPECT_EQ(*state.position, Vec3(0.1, 0.2, 0.3)) << broken;
    }
    EXPECT_EQ(take_message(state, moved("A", Vec3(0.2, 0, 0))), News::state);
}

TEST(HaplyProtocol, a_first_position_has_three_components) {
    ServiceState state;
    EXPECT_EQ(take_message(
                  state, R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":0}}}]})"),
              News::refused);
    EXPECT_FALSE(state.position);
}

TEST(HaplyProtocol, what_is_no_message_is_refused) {
    const std::string good = snapshot({whole_device("A")});
    ServiceState state = after({good});
    const std::string bomb(1000, '[');
    for (const std::string& text :
         {std::string(), std::string("hello"), std::string("[]"), std::string("17"),
          good.substr(0, good.size() / 2), std::string(R"({"inverse3":7})"), bomb,
          R"({"a":)" + bomb,
          std::string("{\"inverse3\":[{\"state\":{\"cursor_position\":"
                      "{\"x\":NaN,\"y\":0,\"z\":0}}}]}"),
          std::string(
              R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":1e999}}}]})"),
          std::string("\0\0\0", 3), "{\"pad\":\"" + std::string(longest_message, ' ') + "\"}"}) {
        EXPECT_EQ(take_message(state, text), News::refused) << text.substr(0, 80);
        EXPECT_FALSE(state.error.empty());
    }
    EXPECT_EQ(take_message(state, good), News::state);
}

TEST(HaplyProtocol, brackets_in_strings_are_not_depth) {
    ServiceState state;
    EXPECT_EQ(take_message(state, R"({"note":"\"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["})"),
              News::none);
}

TEST(HaplyProtocol, only_a_calibrated_started_device_is_ready) {
    const auto told = [](const std::string& its_status) {
        return after({snapshot({whole_device("A", Vec3(0, 0, 0), its_status)})});
    };
    EXPECT_EQ(status_of(told(status(false))), DeviceStatus::uncalibrated);
    EXPECT_NE(problem_of(told(status(false))).find("calibrate"), std::string::npos);
    EXPECT_EQ(status_of(told(status(true, false))), DeviceStatus::starting);
    EXPECT_EQ(status_of(told(status(true, true, false))), DeviceStatus::starting);
    EXPECT_NE(problem_of(told(status(true, true, false))), "");
    EXPECT_EQ(status_of(told(R"("status":{})")), DeviceStatus::starting);
    EXPECT_EQ(status_of(told(R"("status":{"calibrated":"yes","ready":1,"started":1})")),
              DeviceStatus::uncalibrated);
    EXPECT_EQ(status_of(ServiceState{}), DeviceStatus::starting);
}

TEST(HaplyProtocol, the_grip_has_buttons_and_an_orientation_that_come_in_any_message) {
    const std::string device = snapshot({whole_device("A")});
    ServiceState state = after({device});
    EXPECT_TRUE(state.grip.list.empty());
    take_message(
        state,
        with_grip(device, R"("device_id":"G","state":{"buttons":{"a":true,"b":false,"c":true}})"));
    EXPECT_EQ(state.grip.buttons, 5U);
    // 90 degrees about z, and button a let go.
    take_message(state,
                 with_grip(moved("A", Vec3(0, 0, 0)),
                           R"("device_id":"G","state":{"orientation":{"w":0.70710678,"x":0,"y":0,
                              "z":0.70710678},"buttons":{"a":false}})"));
    EXPECT_EQ(state.grip.buttons, 4U);
    EXPECT_LT((state.grip.orientation * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm(), 1e-7);
    // Messages without the grip, or without the id, change nothing.
    take_message(state, moved("A", Vec3(0, 0, 0)));
    EXPECT_EQ(state.grip.buttons, 4U);
    take_message(state, with_grip("{}", R"("state":{"buttons":{"b":true}})").replace(1, 1, ""));
    EXPECT_EQ(state.grip.buttons, 6U);
}

TEST(HaplyProtocol, a_wired_grip_has_one_button) {
    ServiceState state =
        after({with_grip(snapshot({whole_device("A")}),
                         R"("device_id":"1","state":{"button":true,"hall":0})", "verse_grip")});
    EXPECT_EQ(state.grip.buttons, 1U);
}

TEST(HaplyProtocol, a_wired_grip_turns_as_a_wireless_one_does) {
    for (const std::string list : {"verse_grip", "wireless_verse_grip"}) {
        const ServiceState state = after({with_grip(
            snapshot({whole_device("A")}),
            R"("device_id":"1","state":{"orientation":{"w":0,"x":0,"y":0,"z":1}})", list)});
        EXPECT_EQ(state.grip.list, list);
        EXPECT_LE((state.grip.orientation * Vec3(1, 2, 3) - Vec3(-1, -2, 3)).norm(), 1e-12);
    }
}

TEST(HaplyProtocol, a_grip_that_is_gone_keeps_its_last_orientation_until_another_tells_one) {
    const std::string half = R"("orientation":{"w":0,"x":1,"y":0,"z":0})";
    ServiceState state = after(
        {with_grip(snapshot({whole_device("A")}), R"("device_id":"G","state":{)" + half + "}")});
    const Mat3 last = state.grip.orientation;
    EXPECT_LE((last * Vec3(1, 2, 3) - Vec3(1, -2, -3)).norm(), 1e-12);
    take_message(state, R"({"inverse3":[{"device_id":"A"}],"wireless_verse_grip":[]})");
    EXPECT_TRUE(state.grip.list.empty());
    EXPECT_EQ(state.grip.orientation, last);
    take_message(state, with_grip(moved("A", Vec3(0, 0, 0)),
                                  R"("device_id":"H","state":{"orientation":{"w":0,"x":0,"y":0,)"
                                  R"("z":0}})",
                                  "verse_grip"));
    EXPECT_EQ(state.grip.orientation, last);  // zeros turn nothing: it sleeps
    take_message(state, with_grip(moved("A", Vec3(0, 0, 0)),
                                  R"("device_id":"H","state":{"orientation":{"w":1,"x":0,"y":0,)"
                                  R"("z":0}})",
                                  "verse_grip"));
    EXPECT_EQ(state.grip.orientation, Mat3(Mat3::Identity()));
}

/// Additions of service 3.5 to the first message are ignored.
TEST(HaplyProtocol, the_first_message_of_service_3_5_is_understood) {
    const std::string device =
        R"({"device_id":"049D","config":{"type":"inverse3","handedness":"right",)"
        R"("streaming_mode":"USB","preset":"defaults","home_return":{"enabled":false},)"
        R"("device_info":{"major_version":7,"minor_version":4},"basis":{"permutation":"XYZ"},)"
        R"("mount":{"position":{"x":0,"y":0,"z":0},"scale":{"x":1,"y":1,"z":1}},)"
        R"("filters":{"force_gate":{"gain":0.3},"damping":{"scalar":0}}},)"
        R"("state":{"cursor_position":{"x":0.01,"y":-0.12,"z":0.15},)"
        R"("body_orientation":{"w":1,"x":0,"y":0,"z":0},"control_domain":"cartesian",)"
        R"("transform":{"position":{"x":0,"y":0,"z":0},"rotation":{"w":1,"x":0,"y":0,"z":0}}},)" +
        support::status() + "}";
    const std::string grip =
        R"("device_id":"61548","config":{"type":"wireless_verse_grip"},"state":{"orientation":)"
        R"({"w":0,"x":1,"y":0,"z":0},"buttons":{"a":true,"b":false,"c":false},)"
        R"("battery_level":0.9},"status":{"connected":true,"awake":true,"ready":true})";
    const ServiceState state = after({with_grip(snapshot({device}), grip)});
    EXPECT_EQ(state.device_id, "049D");
    ASSERT_TRUE(state.position);
    EXPECT_EQ(*state.position, Vec3(0.01, -0.12, 0.15));
    EXPECT_EQ(status_of(state), DeviceStatus::ready);
    EXPECT_EQ(problem_of(state), "");
    EXPECT_EQ(state.grip.buttons, 1U);
    EXPECT_LE((state.grip.orientation * Vec3(0, 0, 1) - Vec3(0, 0, -1)).norm(), 1e-12);
}

TEST(HaplyProtocol, a_grip_that_is_gone_holds_no_button) {
    const std::string held = with_grip(snapshot({whole_device("A")}),
                                       R"("device_id":"G","state":{"buttons":{"b":true}})");
    ServiceState state = after({held});
    EXPECT_EQ(state.grip.buttons, 2U);
    take_message(state, R"({"inverse3":[{"device_id":"A"}],"wireless_verse_grip":[]})");
    EXPECT_EQ(state.grip.buttons, 0U);

    state = after({held});
    take_message(state, with_grip(moved("A", Vec3(0, 0, 0)),
                                  R"("device_id":"G","status":{"connected":false})"));
    EXPECT_EQ(state.grip.buttons, 0U);

    state = after({held});
    take_message(state, with_grip(moved("A", Vec3(0, 0, 0)),
                                  R"("device_id":"G","state":{"buttons":{"b":"maybe"}})"));
    EXPECT_EQ(state.grip.buttons, 0U);
}

TEST(HaplyProtocol, an_orientation_that_is_none_is_passed_over) {
    ServiceState state = after({snapshot({whole_device("A")})});
    for (const char* broken :
         {R"({"w":0,"x":0,"y":0,"z":0})", R"({"w":1})", "null",
          R"({"w":1e200,"x":1e200,"y":0,"z":0})", R"({"w":"1","x":0,"y":0,"z":0})"}) {
        EXPECT_EQ(take_message(state, with_grip(moved("A", Vec3(0, 0, 0)),
                                                R"("device_id":"G","state":{"orientation":)" +
                                                    std::string(broken) + "}")),
                  News::state);
        EXPECT_EQ(state.grip.orientation, Mat3(Mat3::Identity())) << broken;
    }
}

TEST(HaplyProtocol, complaints_are_shown_on_one_line) {
    ServiceState state = after({snapshot({whole_device("A")})});
    take_message(state, "{\"error\":\"no such\\ncommand \\u001b[31m\"}");
    EXPECT_EQ(problem_of(state), "the service says: no such?command ?[31m");
    take_message(state, R"({"errors":[{"code":3,"message":"busy"}]})");
    EXPECT_EQ(problem_of(state), "the service says: busy");
    take_message(state, R"({"inverse3":[{"device_id":"A","status":{"error":"too warm"}}]})");
    EXPECT_EQ(problem_of(state), "the service says: too warm");
    take_message(state, moved("A", Vec3(0, 0, 0)));
    EXPECT_EQ(problem_of(state), "");
}

TEST(HaplyProtocol, an_unplugged_supply_and_other_axes_are_mentioned) {
    ServiceState state = after({snapshot({whole_device("A")})});
    take_message(state, R"({"inverse3":[{"device_id":"A","status":{"power_supply":false}}]})");
    EXPECT_NE(problem_of(state).find("no power"), std::string::npos);
    std::string other = snapshot({whole_device("A")});
    other.replace(other.find("XYZ"), 3, "XZY");
    EXPECT_NE(problem_of(after({other})).find("XZY"), std::string::npos);
}

TEST(HaplyProtocol, a_force_arrives_as_written_under_either_key) {
    const Vec3 force(1.0 / 3, -1e-300, 9.999999999999998);
    ForceCommand values("049D", ForceKey::values), vector("049D", ForceKey::vector);
    for (int round = 0; round < 2; ++round) {
        const auto json = nlohmann::json::parse(values.with(force));
        const auto& device = json["inverse3"][0];
        EXPECT_EQ(device["device_id"], "049D");
        const auto& given = device["commands"]["set_cursor_force"]["values"];
        EXPECT_EQ(given["x"].get<double>(), force[0]);
        EXPECT_EQ(given["y"].get<double>(), force[1]);
        EXPECT_EQ(given["z"].get<double>(), force[2]);
    }
    const auto json = nlohmann::json::parse(vector.with(force));
    EXPECT_EQ(json["inverse3"][0]["commands"]["set_cursor_force"]["vector"]["z"].get<double>(),
              force[2]);
}

TEST(HaplyProtocol, a_force_that_is_not_finite_is_zero) {
    ForceCommand command("A", ForceKey::values);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const auto json = nlohmann::json::parse(command.with(Vec3(1, bad, 1)));
        EXPECT_EQ(json["inverse3"][0]["commands"]["set_cursor_force"]["values"],
                  (nlohmann::json{{"x", 0.0}, {"y", 0.0}, {"z", 0.0}}));
    }
}

TEST(HaplyProtocol, the_longest_command_fits_and_allocates_nothing) {
    const std::string id(64, 'W');
    const double longest = -1.2345678901234567e-300;
    const auto before = thread_allocation_count();
    ForceCommand command(id, ForceKey::vector);
    const std::string_view text = command.with(Vec3(longest, longest, longest));
    EXPECT_EQ(thread_allocation_count(), before);
    EXPECT_FALSE(nlohmann::json::parse(text, nullptr, false).is_discarded());
}

TEST(HaplyProtocol, an_id_that_would_not_stand_in_a_command_is_no_device) {
    EXPECT_TRUE(is_device_id("049D"));
    for (const std::string& bad : {std::string(), std::string("a\"b"), std::string("a\\b"),
                                   std::string("a b"), std::string(65, 'a'), std::string("\n")}) {
        EXPECT_FALSE(is_device_id(bad));
        EXPECT_THROW(ForceCommand(bad, ForceKey::values), std::invalid_argument);
    }
    ServiceState state;
    EXPECT_EQ(take_message(state, R"({"inverse3":[{"device_id":"a\",\"b"},{"device_id":5}]})"),
              News::gone);
}

TEST(HaplyProtocol, axes_are_signed_and_never_mirrored) {
    const Mat3 axes = axes_from("xz-y");
    EXPECT_EQ(axes * Vec3(1, 2, 3), Vec3(1, 3, -2));
    EXPECT_EQ(axes_from("xyz"), Mat3(Mat3::Identity()));
    EXPECT_EQ(axes_from("-x-yz") * Vec3(1, 2, 3), Vec3(-1, -2, 3));
    for (const char* bad :
         {"", "x", "xy", "xzy", "xxz", "xz-y ", "xz-yz", "+xz-y", "abc", "--xyz"}) {
        EXPECT_THROW(axes_from(bad), std::invalid_argument) << bad;
    }
}

}  // namespace
}  // namespace palpate::devices::haply
