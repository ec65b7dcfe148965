// The device against a service that misbehaves: no force, no waiting servo, and back again.
#include "devices/haply/haply_fixture.hpp"
#include "devices/haply/inverse3.hpp"
#include "support/allocation_counter.hpp"

namespace palpate::devices {
namespace {

TEST_F(HaplyTest, silence_is_stale_and_the_force_goes) {
    const auto device = open("timeout=5");
    ASSERT_TRUE(until_pressed(*device));
    service.mute(true);
    ASSERT_TRUE(until_status(*device, DeviceStatus::stale));
    EXPECT_TRUE(nothing_is_felt(*device));  // and it goes on asking
    EXPECT_TRUE(
        until([&] { return device->problem().find("does not answer") != std::string::npos; }));
    EXPECT_EQ(service.connections(), 1);
}

TEST_F(HaplyTest, questions_do_not_pile_up_before_a_silent_service) {
    const auto device = open("timeout=5");
    ASSERT_TRUE(until_status(*device, DeviceStatus::ready));
    service.mute(true);
    ASSERT_TRUE(until_status(*device, DeviceStatus::stale));
    const auto begin = std::chrono::steady_clock::now();
    const std::size_t before = service.messages();
    ASSERT_TRUE(until([&] { return service.messages() > before + 40; }));
    const auto count = static_cast<double>(service.messages() - before);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    // One in 5 ms, and some that the service has not taken before.
    EXPECT_LE(count, 200 * time.count() + 20);
}

TEST_F(HaplyTest, a_force_from_before_it_was_ready_is_not_felt) {
    const auto device = open();
    for (int round = 0; round < 10; ++round) {
        service.answer("garbage");
        ASSERT_TRUE(until([&] { return device->read(0).status == DeviceStatus::fault; }));
        device->write({push}, 0);
        service.answer(moved(id, Vec3(0, 0, 0)));
        ASSERT_TRUE(until([&] { return device->read(0).status == DeviceStatus::ready; }));
        const std::size_t now = service.messages();
        ASSERT_TRUE(until([&] { return service.messages() > now + 5; }));
    }
    for (const Vec3& force : service.forces()) EXPECT_TRUE(force.isZero(0));
}

TEST_F(HaplyTest, a_connection_that_stays_behind_is_opened_anew) {
    const auto device = open("timeout=0.1");
    ASSERT_TRUE(until_pressed(*device));
    service.mute(true);
    ASSERT_TRUE(until([&] { return service.connections() > 1; }));
    service.mute(false);
    EXPECT_TRUE(until_status(*device, DeviceStatus::ready));
}

TEST_F(HaplyTest, answers_that_come_late_are_never_ready) {
    service.delay(40ms);
    const auto device = open("timeout=5");
    bool ready = false;
    ASSERT_TRUE(until([&] {
        ready = ready || press(*device) == DeviceStatus::ready;
        return device->problem().find("too late") != std::string::npos && service.messages() > 50;
    }));
    EXPECT_FALSE(ready);
    EXPECT_EQ(device->read(0).status, DeviceStatus::stale);
    for (const Vec3& force : service.forces()) EXPECT_TRUE(force.isZero(0));
}

TEST_F(HaplyTest, one_long_pause_is_caught_up_with) {
    const auto device = open("timeout=5");
    ASSERT_TRUE(until_pressed(*device));
    service.hang(true);
    ASSERT_TRUE(until_status(*device, DeviceStatus::stale));
    std::this_thread::sleep_for(100ms);
    service.hang(false);
    ASSERT_TRUE(until_status(*device, DeviceStatus::ready));
    EXPECT_TRUE(until_pressed(*device, service.forces().size()));
    EXPECT_EQ(service.connections(), 1);
}

TEST_F(HaplyTest, broken_messages_are_a_fault_until_the_next_good_one) {
    const std::string good = moved(id, Vec3(0.1, 0, 0));
    const std::vector<MockService::Reply> broken{
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
        ASSERT_TRUE(until_pressed(*device, service.forces().size()));
        service.answer([reply](const std::string&) { return reply; });
        ASSERT_TRUE(until_status(*device, DeviceStatus::fault)) << reply.text.substr(0, 80);
        EXPECT_TRUE(nothing_is_felt(*device)) << reply.text.substr(0, 80);
        EXPECT_TRUE(until_problem(*device, " sent a")) << device->problem();
        // The last good position stays.
        EXPECT_EQ(device->read(0).position, Vec3(100, 0, 0));
    }
    EXPECT_EQ(service.connections(), 1);
}

TEST_F(HaplyTest, what_breaks_the_connection_is_followed_by_a_new_one) {
    const std::string good = moved(id, Vec3(0.1, 0, 0));
    const auto device = open();
    int connections = 1;
    for (const std::string& reply :
         {std::string((std::size_t{1} << 20) + 1, ' '), std::string("\xff\xfe")}) {
        service.answer(good);
        ASSERT_TRUE(until_status(*device, DeviceStatus::ready));
        service.answer(reply);
        ASSERT_TRUE(until_status(*device, DeviceStatus::lost));
        service.answer(good);
        ASSERT_TRUE(until_status(*device, DeviceStatus::ready));
        EXPECT_GT(service.connections(), connections);
        connections = service.connections();
    }
}

TEST_F(HaplyTest, a_break_while_pressing_is_lost_then_ready_without_force_in_between) {
    const auto device = open();
    ASSERT_TRUE(until_pressed(*device));
    service.refuse(true);  // until the loss was seen
    service.drop();
    ASSERT_TRUE(until_status(*device, DeviceStatus::lost));
    EXPECT_TRUE(until_problem(*device, "trying to connect again"));
    EXPECT_EQ(device->read(0).position, Vec3(100, 300, 200));
    const std::size_t before = service.forces().size();
    service.refuse(false);
    ASSERT_TRUE(until_pressed(*device, before));
    EXPECT_EQ(service.connections(), 2);
    EXPECT_TRUE(service.forces()[before].isZero(0));
    EXPECT_TRUE(until_status(*device, DeviceStatus::ready));
    EXPECT_TRUE(until([&] { return press(*device), device->problem().empty(); }));
}

TEST_F(HaplyTest, the_first_message_of_a_new_connection_counts_afresh) {
    const auto device = open();
    ASSERT_TRUE(until_status(*device, DeviceStatus::ready));
    service.greet(snapshot({whole_device("NEW1", Vec3(0, 0, 0), status(false))}));
    service.answer(moved("NEW1", Vec3(0, 0, 0.1)));
    service.drop();
    ASSERT_TRUE(until_status(*device, DeviceStatus::uncalibrated));
    EXPECT_EQ(device->read(0).position, Vec3(0, 100, 0));
    EXPECT_NE(device->info().model.find("NEW1"), std::string::npos);
}

TEST_F(HaplyTest, goes_on_trying_while_it_is_refused) {
    const auto device = open();
    ASSERT_TRUE(until_status(*device, DeviceStatus::ready));
    service.refuse(true);
    service.drop();
    ASSERT_TRUE(until_status(*device, DeviceStatus::lost));
    std::this_thread::sleep_for(400ms);  // some attempts
    EXPECT_EQ(device->read(0).status, DeviceStatus::lost);
    service.refuse(false);
    EXPECT_TRUE(until_status(*device, DeviceStatus::ready));
}

TEST_F(HaplyTest, an_unplugged_device_is_lost_until_it_is_back) {
    const auto device = open();
    ASSERT_TRUE(until_pressed(*device));
    service.answer(snapshot({}));
    ASSERT_TRUE(until_status(*device, DeviceStatus::lost));
    EXPECT_TRUE(nothing_is_felt(*device));
    EXPECT_TRUE(until_problem(*device, "plug it in"));
    service.answer(snapshot({whole_device(id)}));
    EXPECT_TRUE(until_pressed(*device, service.forces().size()));
}

TEST_F(HaplyTest, a_service_that_comes_back_before_its_device_is_asked_for_it) {
    const auto device = open();
    ASSERT_TRUE(until_status(*device, DeviceStatus::ready));
    service.greet(snapshot({}));
    service.answer(snapshot({}));
    service.drop();
    ASSERT_TRUE(until([&] {
        return service.last_message().find("force_render_full_state") != std::string::npos;
    }));
    EXPECT_EQ(device->read(0).status, DeviceStatus::lost);
    service.answer(snapshot({whole_device(id)}));
    EXPECT_TRUE(until_pressed(*device, service.forces().size()));
}

TEST_F(HaplyTest, a_service_that_hangs_before_it_shakes_hands_is_given_up) {
    service.hang(true);
    const std::string said = refusal();
    EXPECT_NE(said.find("127.0.0.1:"), std::string::npos) << said;
    EXPECT_NE(said.find("does not answer as a WebSocket"), std::string::npos) << said;
}

TEST_F(HaplyTest, the_servo_never_waits_for_a_service_that_hangs) {
    const auto device = open();
    ASSERT_TRUE(until_pressed(*device));
    service.hang(true);
    ASSERT_TRUE(until_status(*device, DeviceStatus::stale));
    const auto begin = std::chrono::steady_clock::now();
    const auto allocations = thread_allocation_count();
    for (int i = 0; i < 1000; ++i) press(*device);
    EXPECT_EQ(thread_allocation_count(), allocations);
    // A call that waited would take at least a millisecond, and a second in all; the machine may
    // stall.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s);
}

TEST_F(HaplyTest, closing_does_not_wait_for_a_service_that_hangs) {
    for (const bool connected : {true, false}) {
        service.hang(false);
        auto device = open();
        ASSERT_TRUE(until_status(*device, DeviceStatus::ready));
        service.hang(true);
        if (!connected) service.drop();
        ASSERT_TRUE(until_status(*device, connected ? DeviceStatus::stale : DeviceStatus::lost));
        if (!connected) std::this_thread::sleep_for(150ms);  // in an attempt to connect
        const auto begin = std::chrono::steady_clock::now();
        device.reset();
        // Half a second is meant; the machine may stall.
        EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s);
    }
}

TEST_F(HaplyTest, sending_a_force_allocates_nothing) {
    const haply::Address address = haply::look_up("127.0.0.1", service.port());
    haply::Talk talk;
    ASSERT_EQ(start_talk(talk, address, "", haply::Clock::now() + 10s), "");
    const auto send = [&] {
        haply::ForceCommand command(talk.state.device_id, haply::ForceKey::values);
        return talk.socket.send(command.with(Vec3(1.25, -2, 1.0 / 3)), haply::Clock::now() + 10s);
    };
    ASSERT_TRUE(send());  // the first one makes room
    service.hang(true);
    talk.socket.receive(haply::Clock::now() + 20ms);  // a read is underway, as in the device
    const auto before = thread_allocation_count();
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(send());
    EXPECT_EQ(thread_allocation_count(), before);
}

TEST_F(HaplyTest, a_service_that_takes_nothing_more_is_given_up) {
    const haply::Address address = haply::look_up("127.0.0.1", service.port());
    haply::Talk talk;
    ASSERT_EQ(start_talk(talk, address, "", haply::Clock::now() + 10s), "");
    service.hang(true);
    const std::string much(1 << 20, ' ');
    int sent = 0;
    while (sent < 100 && talk.socket.send(much, haply::Clock::now() + 50ms)) ++sent;
    EXPECT_LT(sent, 100);
    EXPECT_EQ(talk.socket.error(), "it takes no messages");
    EXPECT_FALSE(talk.socket.send("x", haply::Clock::now() + 50ms));
    EXPECT_EQ(talk.socket.receive(haply::Clock::now()).what, haply::Received::What::closed);
}

TEST(HaplyQuestions, an_answer_is_as_old_as_its_question) {
    haply::Questions questions;
    const haply::Clock::time_point start = haply::Clock::now();
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
    const haply::Clock::time_point start = haply::Clock::now();
    for (int i = 0; i < 1024; ++i) questions.asked(start);
    EXPECT_GT(questions.behind(start), 1h);
}

}  // namespace
}  // namespace palpate::devices
