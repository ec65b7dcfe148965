// The device against a service that misbehaves: no force, no waiting servo, and back again.
#include <optional>

#include "devices/claim.hpp"
#include "devices/haply/haply_fixture.hpp"
#include "support/allocation_counter.hpp"

namespace palpate::devices {
namespace {

/// A reading goes stale after 20 ms, and without answers the device looks every 5 ms.
constexpr auto goes_stale = 25ms;

TEST_F(HaplyTest, silence_is_stale_and_the_force_goes) {
    const auto device = open("timeout=5");
    ASSERT_TRUE(is_pressed(*device));
    service.mute(true);
    const std::int64_t then = virtual_now();
    ASSERT_TRUE(becomes(*device, DeviceStatus::stale, goes_stale));
    EXPECT_GE(passed_since(then), 19ms);
    EXPECT_TRUE(nothing_is_felt(*device));  // and it goes on asking
    EXPECT_TRUE(says(*device, "does not answer"));
    EXPECT_EQ(service.connections(), 1);
}

TEST_F(HaplyTest, questions_do_not_pile_up_before_a_silent_service) {
    const auto device = open("timeout=5");
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    service.mute(true);
    ASSERT_TRUE(becomes(*device, DeviceStatus::stale, goes_stale));
    const std::size_t before = service.messages();
    EXPECT_TRUE(throughout(1s, [] { return true; }));
    EXPECT_NEAR(static_cast<double>(service.messages() - before), 200, 1);  // one in 5 ms
}

TEST_F(HaplyTest, a_force_from_before_it_was_ready_is_not_felt) {
    const auto device = open();
    const auto is = [&](DeviceStatus status) {
        return within(soon, [&] { return device->read(0).status == status; });
    };
    for (int round = 0; round < 10; ++round) {
        service.answer("garbage");
        ASSERT_TRUE(is(DeviceStatus::fault));
        device->write({push}, 0);
        service.answer(moved(id, Vec3(0, 0, 0)));
        ASSERT_TRUE(is(DeviceStatus::ready));
        EXPECT_TRUE(throughout(50ms, [] { return true; }));
    }
    for (const Vec3& force : service.forces()) EXPECT_TRUE(force.isZero(0));
}

TEST_F(HaplyTest, a_connection_that_stays_behind_is_opened_anew) {
    const auto device = open("timeout=0.1");
    ASSERT_TRUE(is_pressed(*device));
    service.mute(true);
    EXPECT_TRUE(throughout(99ms, [&] { return device->read(0).status != DeviceStatus::lost; }));
    ASSERT_TRUE(within(6ms, [&] { return device->read(0).status == DeviceStatus::lost; }));
    service.mute(false);
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 101ms));
    EXPECT_EQ(service.connections(), 2);
}

TEST_F(HaplyTest, answers_that_come_late_are_never_ready) {
    service.delay(40ms);
    const auto device = open("timeout=5");
    EXPECT_TRUE(throughout(
        1s, [&] { return device->read(0).status != DeviceStatus::ready; },
        [&] { press(*device); }));
    EXPECT_TRUE(says(*device, "too late"));
    EXPECT_GT(service.messages(), 50U);
    EXPECT_EQ(device->read(0).status, DeviceStatus::stale);
    for (const Vec3& force : service.forces()) EXPECT_TRUE(force.isZero(0));
}

TEST_F(HaplyTest, one_long_pause_is_caught_up_with) {
    const auto device = open("timeout=5");
    ASSERT_TRUE(is_pressed(*device));
    service.hang(true);
    ASSERT_TRUE(becomes(*device, DeviceStatus::stale, goes_stale));
    EXPECT_TRUE(throughout(1s, [&] { return device->read(0).status == DeviceStatus::stale; }));
    service.hang(false);
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready, 10ms));
    EXPECT_TRUE(is_pressed(*device));
    EXPECT_EQ(service.connections(), 1);
}

TEST_F(HaplyTest, broken_messages_are_a_fault_until_the_next_good_one) {
    const std::string good = moved(id, Vec3(0.1, 0, 0));
    const std::vector<FakeService::Reply> broken{
        {"garbage", false},
        {good, true},
        {"\1\2\3", true},
        {good.substr(0, good.size() / 2), false},
        {moved(id, Vec3(1e9, 0, 0)), false},
        {R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":"NaN","y":0,"z":0}}}]})",
         false},
        {std::string(100000, '['), false}};
    const auto device = open();
    for (const auto& reply : broken) {
        service.answer(good);
        ASSERT_TRUE(is_pressed(*device));
        service.answer([reply](const std::string&) { return reply; });
        ASSERT_TRUE(becomes(*device, DeviceStatus::fault)) << reply.text.substr(0, 80);
        EXPECT_TRUE(nothing_is_felt(*device)) << reply.text.substr(0, 80);
        EXPECT_TRUE(says(*device, " sent a")) << device->problem();
        // The last good position stays.
        EXPECT_EQ(device->read(0).position, Vec3(100, 0, 0));
    }
    EXPECT_EQ(service.connections(), 1);
}

TEST_F(HaplyTest, a_break_while_pressing_is_lost_then_ready_without_force_in_between) {
    const auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    service.drop();
    ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
    EXPECT_TRUE(says(*device, "trying to connect again"));
    EXPECT_EQ(device->read(0).position, Vec3(100, 300, 200));
    const std::size_t before = service.forces().size();
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 101ms));
    ASSERT_TRUE(is_pressed(*device));
    EXPECT_EQ(service.connections(), 2);
    EXPECT_TRUE(service.forces()[before].isZero(0));
    EXPECT_EQ(device->read(0).status, DeviceStatus::ready);
    EXPECT_EQ(device->problem(), "");
}

TEST_F(HaplyTest, a_break_is_noticed_without_memory_for_words) {
    const auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    service.drop();
    {
        const DeniedAllocations denied(64, 1 << 20);
        for (int i = 0; i < 20; ++i) step();
    }
    EXPECT_EQ(device->read(0).status, DeviceStatus::lost);
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 3s));
}

TEST_F(HaplyTest, the_first_message_of_a_new_connection_counts_afresh) {
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    service.greet(snapshot({whole_device(id, Vec3(0, 0, 0), status(false))}));
    service.answer(moved(id, Vec3(0, 0, 0.1)));
    service.drop();
    ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated, 102ms));
    EXPECT_EQ(device->read(0).position, Vec3(0, 100, 0));
}

/// Its limits and its workspace would be those of the one that was found first.
TEST_F(HaplyTest, another_device_that_is_there_after_a_break_gets_no_force) {
    const auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    const std::string other =
        R"({"session_id":7,"minverse":[)" + whole_device("M1", Vec3(0.1, -0.2, 0.3)) + "]}";
    service.greet(other);
    service.answer(other);
    service.drop();
    ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
    const std::size_t before = service.forces().size();
    EXPECT_TRUE(says(*device, "has no device 049D; attached: M1", 1s)) << device->problem();
    EXPECT_TRUE(throughout(
        1s, [&] { return device->read(0).status == DeviceStatus::lost; }, [&] { press(*device); }));
    EXPECT_EQ(service.forces().size(), before) << "a command to another device";
    EXPECT_NE(device->info().model.find(id), std::string::npos);
    service.greet(snapshot({whole_device(id)}));
    service.answer(moved(id, Vec3(0.1, -0.2, 0.3)));
    service.drop();
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 3s));
    EXPECT_TRUE(is_pressed(*device));
}

TEST_F(HaplyTest, goes_on_trying_while_it_is_refused) {
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    service.refuse(true);
    service.drop();
    ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
    const int before = service.attempts();
    EXPECT_TRUE(throughout(10s, [&] { return device->read(0).status == DeviceStatus::lost; }));
    // After 0.1 s, 0.2, 0.4, 0.8, 1.6, and every 2 s from then on.
    EXPECT_EQ(service.attempts() - before, 8);
    service.refuse(false);
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 2s));
    service.drop();  // the next time it begins with 0.1 s again
    ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 102ms));
}

TEST_F(HaplyTest, an_unplugged_device_is_lost_until_it_is_back) {
    const auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    service.answer(snapshot({}));
    ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
    EXPECT_TRUE(nothing_is_felt(*device));
    EXPECT_TRUE(says(*device, "plug it in"));
    service.answer(snapshot({whole_device(id)}));
    EXPECT_TRUE(is_pressed(*device));
}

TEST_F(HaplyTest, a_service_that_comes_back_before_its_device_is_asked_for_it) {
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    service.greet(snapshot({}));
    service.answer(snapshot({}));
    service.drop();
    ASSERT_TRUE(within(102ms, [&] { return service.connections() == 2; }));
    const std::size_t before = service.messages();
    EXPECT_TRUE(throughout(1s, [&] { return device->read(0).status == DeviceStatus::lost; }));
    EXPECT_NEAR(static_cast<double>(service.messages() - before), 10, 1);  // every 100 ms
    EXPECT_NE(service.last_message().find("force_render_full_state"), std::string::npos);
    service.answer(snapshot({whole_device(id)}));
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready, 101ms));
    EXPECT_TRUE(is_pressed(*device));
}

TEST_F(HaplyTest, the_servo_never_waits_for_a_service_that_hangs) {
    const auto device = open();
    ASSERT_TRUE(is_pressed(*device));
    service.hang(true);
    ASSERT_TRUE(becomes(*device, DeviceStatus::stale, goes_stale));
    const std::int64_t begun = virtual_now();
    const auto allocations = thread_allocation_count();
    for (int i = 0; i < 1000; ++i) {
        press(*device);
        device->read(0);
    }
    EXPECT_EQ(thread_allocation_count(), allocations);
    EXPECT_EQ(passed_since(begun), 0ns);
}

TEST_F(HaplyTest, closing_does_not_wait_for_a_service_that_hangs) {
    for (const bool connected : {true, false}) {
        service.hang(false);
        auto device = open();
        ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
        service.hang(true);
        if (!connected) service.drop();
        const auto status = connected ? DeviceStatus::stale : DeviceStatus::lost;
        ASSERT_TRUE(becomes(*device, status, goes_stale));
        const std::int64_t begun = virtual_now();
        step();  // for an attempt to connect, too, there is no more than a quarter of a second
        device.reset();
        EXPECT_LE(passed_since(begun), connected ? 155ms : 250ms);
    }
}

TEST(HaplyQuestions, an_answer_is_as_old_as_its_question) {
    haply::Questions questions;
    const haply::Clock::time_point start = haply::Clock::time_point(1h);
    questions.asked(start);
    questions.asked(start + 5ms);
    EXPECT_EQ(questions.missing(), 2U);
    EXPECT_EQ(questions.behind(start + 6ms), 6ms);
    EXPECT_EQ(questions.answered(), start);
    EXPECT_EQ(questions.behind(start + 7ms), 7ms);
    EXPECT_EQ(questions.answered(), start + 5ms);
    EXPECT_EQ(questions.missing(), 0U);
    EXPECT_EQ(questions.behind(start + 1s), 0ms);
    // One that nobody asked for.
    EXPECT_EQ(questions.answered(), start + 5ms);
    EXPECT_EQ(questions.missing(), 0U);
    questions.asked(start + 10ms);
    EXPECT_EQ(questions.behind(start + 12ms), 2ms);
}

TEST(HaplyQuestions, more_unanswered_than_it_remembers_is_hopelessly_behind) {
    haply::Questions questions;
    const haply::Clock::time_point start = haply::Clock::time_point(1h);
    for (int i = 0; i < 1024; ++i) questions.asked(start);
    EXPECT_GT(questions.behind(start), 1h);
}

}  // namespace
}  // namespace palpate::devices
