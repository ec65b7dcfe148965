// What other programs may change while we press, and what services understand: mount, preset,
// basis, the key of the force, the lists of devices.
#include "devices/haply/haply_fixture.hpp"

namespace palpate::devices {
namespace {

/// A service of release 3.5 whose settings other programs change over HTTP. It tells them when it
/// is asked for all.
class HaplyMapping : public HaplyTest {
  public:
    HaplyMapping() {
        service.greet(all());
        service.answer([this](const std::string& message) {
            note(message);
            const bool wants_all = message.find("force_render_full_state") != std::string::npos;
            return FakeService::Reply{wants_all ? all() : state()};
        });
    }

    std::string entry(const std::string& inside) const {
        return R"({"session_id":7,")" + list + R"(":[{"device_id":"049D",)" + inside + "}]}";
    }
    std::string told_state() const {
        return R"("state":{"cursor_position":)" + xyz(Vec3(0, -0.12, 0.15)) +
               R"(,"current_cursor_force":)" + xyz(Vec3(rendered, 0, 0)) + R"(,"transform":)" +
               transform + "}";
    }
    std::string state() const { return entry(told_state()); }
    std::string all() const {
        return entry(R"("config":{"preset":")" + preset + R"(","basis":{"permutation":")" + basis +
                     R"("},"handedness":")" + handedness + R"(","mount":)" + mount + "}," +
                     told_state() + "," + status());
    }
    /// It renders forces under its own key alone.
    void note(const std::string& message) {
        const bool is_known = message.find('"' + key + "\":{\"x\"") != std::string::npos;
        rendered = is_known ? service.forces().back().norm() : 0;
    }

    std::string list = "inverse3", preset = "defaults", basis = "XYZ", handedness = "right";
    std::string mount = R"({"position":{"x":0,"y":0,"z":0}})", transform = "{}";
    std::string key = "vector";
    double rendered = 0;  // [N]
};

TEST_F(HaplyMapping, a_change_by_another_program_ends_the_force_within_20_ms_for_good) {
    const std::string turned = R"({"rotation":{"w":0,"x":0,"y":0,"z":1}})";
    const struct {
        const char* what;
        std::string HaplyMapping::*part;
        std::string value;
    } changes[] = {{"mount", &HaplyMapping::mount, turned},
                   {"mount", &HaplyMapping::mount, R"({"scale":{"x":-1,"y":1,"z":1}})"},
                   {"mount", &HaplyMapping::mount, R"({"scale":{"x":"?","y":1,"z":1}})"},
                   {"preset", &HaplyMapping::preset, "led_front"},
                   {"basis", &HaplyMapping::basis, "XZY"},
                   {"handedness", &HaplyMapping::handedness, "left"},
                   {"transform", &HaplyMapping::transform, turned}};
    for (const auto& change : changes) {
        const auto device = open();
        const std::string before = this->*change.part;
        ASSERT_TRUE(is_pressed(*device));
        EXPECT_TRUE(throughout(
            25ms, [&] { return device->read(0).status == DeviceStatus::ready; },
            [&] { press(*device); }));
        this->*change.part = change.value;
        EXPECT_TRUE(within(
            20ms, [&] { return service.forces().back().isZero(0); }, [&] { press(*device); }));
        EXPECT_EQ(device->read(0).status, DeviceStatus::fault);
        EXPECT_NE(device->problem().find("has changed the " + std::string(change.what)),
                  std::string::npos)
            << device->problem();
        this->*change.part = before;  // a program that has interfered once may do so again
        EXPECT_TRUE(nothing_is_felt(*device));
    }
}

TEST_F(HaplyMapping, is_pinned_with_the_first_message_and_what_that_changes_is_no_alarm) {
    preset = "led_front";  // of the program before us
    std::vector<std::string> pins;
    service.answer([&](const std::string& message) {
        if (message.find("\"configure\":{\"preset\"") != std::string::npos) {
            pins.push_back(message);
        }
        if (service.messages() == 20) preset = "defaults";  // it takes a while
        return FakeService::Reply{all()};
    });
    {
        const auto device = open();
        EXPECT_TRUE(is_pressed(*device, 50ms));
        EXPECT_EQ(device->problem(), "");
    }
    ASSERT_EQ(pins.size(), 1U);
    EXPECT_NE(pins[0].find(R"({"preset":{"preset":"defaults"},"basis":{"permutation":"XYZ"}})"),
              std::string::npos);
    preset = "arm_front";
    EXPECT_TRUE(is_pressed(*open("preset=arm_front"), 50ms));
    EXPECT_NE(pins.back().find(R"({"preset":"arm_front"})"), std::string::npos);
    EXPECT_TRUE(is_pressed(*open("preset=keep"), 50ms));
    EXPECT_EQ(pins.size(), 2U);
    EXPECT_NE(refusal("preset=\"").find("a name of the service's"), std::string::npos);
}

TEST_F(HaplyMapping, a_slow_pin_is_waited_for_without_force) {
    preset = "led_front";
    const auto device = open();
    EXPECT_TRUE(throughout(
        500ms, [&] { return device->read(0).status == DeviceStatus::starting && rendered == 0; },
        [&] { press(*device); }));
    EXPECT_EQ(device->problem(), "");
    preset = "defaults";
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 10ms));
    EXPECT_TRUE(is_pressed(*device));
    preset = "led_front";  // from now on it is another program's
    EXPECT_TRUE(becomes(*device, DeviceStatus::fault, 10ms));
}

TEST_F(HaplyMapping, a_pin_that_the_service_ignores_is_told_after_two_seconds) {
    preset = "led_front";
    const auto device = open();
    EXPECT_TRUE(throughout(
        1990ms, [&] { return device->problem().empty(); }, [&] { press(*device); }));
    EXPECT_TRUE(says(*device, "does not take preset defaults", 20ms));
    EXPECT_TRUE(says(*device, "has led_front with basis XYZ"));
    EXPECT_EQ(device->read(0).status, DeviceStatus::fault);
    EXPECT_TRUE(nothing_is_felt(*device));
}

TEST_F(HaplyMapping, a_new_connection_does_not_bring_back_the_force_after_a_change) {
    const auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    handedness = "left";
    ASSERT_TRUE(becomes(*device, DeviceStatus::fault, 20ms));
    service.greet(all());
    service.drop();
    ASSERT_TRUE(within(
        150ms, [&] { return service.connections() == 2; }, [&] { press(*device); }));
    EXPECT_TRUE(nothing_is_felt(*device));
    EXPECT_TRUE(says(*device, "has changed the handedness"));
}

TEST_F(HaplyMapping, the_force_under_another_key_begins_with_a_break_for_the_servo) {
    key = "values";
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    ASSERT_TRUE(within(
        150ms, [&] { return device->read(0).status != DeviceStatus::ready; },
        [&] { press(*device); }));
    EXPECT_TRUE(throughout(
        19ms, [&] { return device->read(0).status != DeviceStatus::ready && rendered == 0; },
        [&] { press(*device); }));
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready, 2ms));
    EXPECT_TRUE(throughout(
        18ms, [&] { return rendered == 0; }, [&] { press(*device); }));
    EXPECT_TRUE(is_pressed(*device));
}

TEST_F(HaplyMapping, a_service_that_answers_the_wrong_key_with_an_error_alone_gets_the_other_one) {
    preset = "led_front";
    service.greet(all());
    key = "values";  // though it looks like a service that takes the other one
    service.answer([this](const std::string& message) {
        if (message.find("\"values\":{") == std::string::npos) {
            return FakeService::Reply{R"({"error":"set_cursor_force: no values"})"};
        }
        if (message.find("\"configure\":{\"preset\"") != std::string::npos) preset = "defaults";
        note(message);
        return FakeService::Reply{all()};
    });
    const auto device = open();
    EXPECT_TRUE(is_pressed(*device, 60ms));
    EXPECT_EQ(device->problem(), "");
}

TEST_F(HaplyMapping, without_power_no_key_is_blamed) {
    key = "newtons";
    service.answer([this](const std::string&) {
        std::string answer = all();
        const std::string on = R"("power_supply":true)";
        return FakeService::Reply{
            answer.replace(answer.find(on), on.size(), R"("power_supply":false)")};
    });
    const auto device = open();
    EXPECT_TRUE(throughout(
        500ms, [&] { return service.last_message().find("\"values\"") == std::string::npos; },
        [&] { press(*device); }));
    EXPECT_TRUE(says(*device, "has no power for forces"));
}

TEST_F(HaplyMapping, the_force_goes_under_the_key_that_the_service_renders) {
    {
        const auto device = open();
        ASSERT_TRUE(is_pressed(*device));
        EXPECT_GT(rendered, 3);
    }
    key = "values";  // though it looks like a service that takes the other one
    {
        const auto device = open();
        EXPECT_TRUE(within(
            200ms, [&] { return rendered > 3; }, [&] { press(*device); }));
        EXPECT_TRUE(throughout(
            100ms, [&] { return rendered > 3; }, [&] { press(*device); }));
    }
    key = "newtons";
    const auto neither = open();
    EXPECT_TRUE(within(
        500ms, [&] { return neither->problem().find("force_key") != std::string::npos; },
        [&] { press(*neither); }));
}

TEST_F(HaplyMapping, a_key_that_the_service_complains_of_is_left_at_once) {
    std::string used;
    service.greet(snapshot({whole_device(id)}));  // an old one, so it seems
    service.answer([&](const std::string& message) {
        const bool takes = message.find("\"vector\":{") != std::string::npos;
        used = takes ? "vector" : "values";
        std::string answer = moved(id, Vec3(0, 0, 0));
        if (!takes) answer.insert(1, R"("error":"set_cursor_force: no vector",)");
        return FakeService::Reply{answer};
    });
    const auto device = open();
    EXPECT_TRUE(within(
        30ms, [&] { return used == "vector"; }, [&] { press(*device); }));
    EXPECT_TRUE(throughout(
        100ms, [&] { return used == "vector"; }, [&] { press(*device); }));
}

TEST_F(HaplyMapping, a_device_in_another_list_is_found_and_pressed) {
    list = "minverse";
    service.greet(all());
    const auto device = open();
    EXPECT_EQ(device->info().model, "Minverse 049D");
    EXPECT_EQ(device->info().limits.maximum_force, 3.3);
    EXPECT_EQ(device->info().workspace_low, Vec3(-57, 80, 18));
    EXPECT_EQ(device->info().workspace_high, Vec3(43, 180, 118));
    EXPECT_TRUE(within(
        felt, [&] { return service.forces().back() == Vec3(1, 0, 0); },
        [&] { device->write({Vec3(1, 0, 0)}, 0); }));
    EXPECT_EQ(service.last_message().find("\"inverse3\""), std::string::npos);
    EXPECT_NE(service.last_message().find(R"("minverse":[{"device_id":"049D")"), std::string::npos);
}

}  // namespace
}  // namespace palpate::devices
