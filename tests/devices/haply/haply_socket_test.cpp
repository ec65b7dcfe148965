// The socket against a real one on the loopback that behaves badly, and the device's thread against
// it at its real pace.
#include <gtest/gtest.h>

#include "devices/haply/haply.hpp"
#include "devices/haply/messages.hpp"
#include "devices/haply/mock_service.hpp"
#include "devices/stepped_device.hpp"
#include "palpate/devices/devices.hpp"
#include "support/allocation_counter.hpp"
#include "support/eventually.hpp"

namespace palpate::devices {
namespace {

using namespace palpate::support;
using namespace std::chrono_literals;

constexpr const char* id = "049D";
/// For expected answers, which come at once. The patience is for slow machines.
constexpr auto patience = 2min;
/// For silence.
constexpr auto no_time = 20ms;

class HaplySocket : public testing::Test {
  protected:
    HaplySocket() {
        service.greet(snapshot({whole_device(id)}));
        service.answer(moved(id, Vec3(0.1, -0.2, 0.3)));
    }
    haply::Address address() const { return haply::look_up("127.0.0.1", service.port()); }
    std::string start(std::chrono::milliseconds time) {
        return start_talk(talk, address(), "", haply::Clock::now() + time);
    }
    bool send(std::string_view message, std::chrono::milliseconds time) {
        return talk.channel->send(message, haply::Clock::now() + time);
    }
    haply::Received receive(std::chrono::milliseconds time) {
        return talk.channel->receive(haply::Clock::now() + time);
    }
    static bool contains(const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    }

    MockService service;
    haply::Talk talk;
};

TEST_F(HaplySocket, a_service_that_hangs_before_it_shakes_hands_is_given_up) {
    service.hang(true);
    const std::string said = start(no_time);
    EXPECT_TRUE(contains(said, "127.0.0.1:")) << said;
    EXPECT_TRUE(contains(said, "does not answer as a WebSocket")) << said;
}

TEST_F(HaplySocket, what_is_no_web_socket_is_told_so) {
    service.speak_http(true);
    const std::string said = start(patience);
    EXPECT_TRUE(contains(said, "no WebSocket")) << said;
}

TEST_F(HaplySocket, where_nothing_listens_that_is_said_with_the_address) {
    std::uint16_t port = 0;
    {
        const MockService gone;
        port = gone.port();
    }
    const std::string place = "127.0.0.1:" + std::to_string(port);
    const std::string said =
        start_talk(talk, haply::look_up("127.0.0.1", port), "", haply::Clock::now() + patience);
    EXPECT_TRUE(contains(said, place)) << said;
    EXPECT_TRUE(contains(said, "haply-inverse-service")) << said;
}

TEST_F(HaplySocket, messages_come_whole_and_as_text_or_binary) {
    ASSERT_EQ(start(patience), "");
    EXPECT_EQ(talk.state.device_id, id);
    for (const bool binary : {false, true}) {
        service.answer([binary](const std::string& said) {
            return MockService::Reply{said + "!", binary};
        });
        ASSERT_TRUE(send("hello", patience));
        const haply::Received received = receive(patience);
        EXPECT_EQ(received.what, haply::Received::What::message);
        EXPECT_EQ(received.binary, binary);
        EXPECT_EQ(received.message, "hello!");
    }
    EXPECT_EQ(receive(no_time).what, haply::Received::What::nothing);
    talk.channel->close(haply::Clock::now() + patience);
    EXPECT_TRUE(comes_true([&] { return service.closed_politely(); }));
}

TEST_F(HaplySocket, too_long_a_message_or_one_that_is_no_text_breaks_the_connection) {
    for (const std::string& reply :
         {std::string((std::size_t{1} << 20) + 1, ' '), std::string("\xff\xfe")}) {
        ASSERT_EQ(start(patience), "");
        service.answer(reply);
        ASSERT_TRUE(send("hello", patience));
        EXPECT_EQ(receive(patience).what, haply::Received::What::closed);
        EXPECT_NE(talk.channel->error(), "");
        EXPECT_FALSE(send("hello", patience));
    }
}

TEST_F(HaplySocket, sending_a_force_allocates_nothing) {
    ASSERT_EQ(start(patience), "");
    const auto send_force = [&] {
        haply::ForceCommand command(talk.state.device_id, haply::ForceKey::values);
        return send(command.with(Vec3(1.25, -2, 1.0 / 3)), patience);
    };
    ASSERT_TRUE(send_force());  // the first one makes room
    service.hang(true);
    while (receive(no_time).what == haply::Received::What::message) {
    }  // a read is underway, as in the device
    const auto before = thread_allocation_count();
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(send_force());
    EXPECT_EQ(thread_allocation_count(), before);
}

TEST_F(HaplySocket, a_service_that_takes_nothing_more_is_given_up) {
    ASSERT_EQ(start(patience), "");
    service.hang(true);
    const std::string much(1 << 20, ' ');
    int sent = 0;
    while (sent < 100 && send(much, no_time)) ++sent;
    EXPECT_LT(sent, 100);
    EXPECT_EQ(talk.channel->error(), "it takes no messages");
    EXPECT_FALSE(send("x", no_time));
    EXPECT_EQ(receive(0ms).what, haply::Received::What::closed);
}

/// The device's thread, at its real pace.
class PacedHaply : public HaplySocket {};

TEST_F(PacedHaply, its_thread_presses_at_4_khz_at_most_connects_again_and_says_goodbye) {
    const auto begun = haply::Clock::now();
    // A busy machine may take longer to answer than opening waits.
    std::unique_ptr<Device> device;
    ASSERT_TRUE(comes_true([&] {
        try {
            device = open_device(parse_device("haply:host=127.0.0.1,timeout=5,port=" +
                                              std::to_string(service.port())),
                                 any_scene());
        } catch (const DeviceError&) {
        }
        return device != nullptr;
    }));
    const auto press = [&] {
        device->write({Vec3(1, 2, 3), Vec3::Zero()}, 0);
        const auto forces = service.forces();
        return !forces.empty() && forces.back() == Vec3(1, -3, 2);
    };
    EXPECT_TRUE(comes_true(press));
    const auto messages = static_cast<double>(service.messages());
    const std::chrono::duration<double> took = haply::Clock::now() - begun;
    EXPECT_LE(messages, 4000 * took.count() + 10);
    EXPECT_TRUE(comes_true([&] { return service.forces().back().isZero(0); }));  // no servo
    const int before = service.connections();
    service.drop();
    EXPECT_TRUE(comes_true([&] { return service.connections() > before && press(); }));
    device.reset();
    EXPECT_TRUE(comes_true([&] { return service.forces().back().isZero(0); }));
    EXPECT_TRUE(comes_true([&] { return service.closed_politely(); }));
}

}  // namespace
}  // namespace palpate::devices
