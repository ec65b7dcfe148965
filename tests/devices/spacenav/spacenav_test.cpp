// The device `spacenav` against a stand-in for the daemon.
#include "devices/spacenav/spacenav.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "devices/spacenav/mock_daemon.hpp"
#include "devices/vendor_polling.hpp"

namespace palpate::devices {
namespace {

using namespace std::chrono_literals;
using support::any_scene;
using support::contains;
using support::eventually;
using support::message_of;
using support::MockDaemon;
using support::throughout;

class Spacenav : public testing::Test {
  protected:
    std::unique_ptr<Device> open(const std::string& options = "") {
        auto device =
            open_spacenav(parse_device("spacenav:socket=" + daemon_.path() + options), any_scene());
        EXPECT_TRUE(daemon_.accept());
        return device;
    }
    static bool becomes(Device& device, DeviceStatus status) {
        return eventually([&] { return device.read(0).status == status; });
    }

    MockDaemon daemon_;
};

TEST_F(Spacenav, a_daemon_that_is_not_there_is_told_with_every_place_that_was_tried) {
    const auto open_nothing = [](const std::string& options) {
        return message_of<DeviceError>(
            [&] { open_spacenav(parse_device("spacenav" + options), any_scene()); });
    };
    const std::string message = open_nothing(":/nowhere/spnav.sock");
    EXPECT_TRUE(contains(message,
                         "device spacenav: no spacenavd listens (/nowhere/spnav.sock: No "
                         "such file or directory)"))
        << message;
    EXPECT_TRUE(contains(message, "apt install spacenavd")) << message;
    EXPECT_TRUE(contains(message, "socket=PATH")) << message;
    EXPECT_TRUE(contains(open_nothing(":socket=" + std::string(200, 'x')), "too long"));
    daemon_.go_away();
    EXPECT_TRUE(contains(open_nothing(":socket=" + daemon_.path()), daemon_.path()));
}

TEST_F(Spacenav, the_environment_says_where_the_socket_is) {
    ASSERT_EQ(setenv("SPNAV_SOCKET", daemon_.path().c_str(), 1), 0);
    const DeviceFinding finding = find_spacenav();
    EXPECT_TRUE(finding.found) << finding.missing;
    EXPECT_EQ(finding.what, "spacenavd at " + daemon_.path());
    EXPECT_TRUE(daemon_.accept());
    const auto device = open_spacenav(parse_device("spacenav"), any_scene());
    EXPECT_EQ(device->info().model, "3D mouse, spacenavd at " + daemon_.path());
    unsetenv("SPNAV_SOCKET");
}

TEST_F(Spacenav, options_that_cannot_be_meant_are_refused) {
    const auto wrong = [&](const std::string& options) {
        return message_of<std::invalid_argument>([&] { open(options); });
    };
    EXPECT_TRUE(contains(wrong(",force=1"), "there are: socket, speed, turn, full"));
    EXPECT_TRUE(contains(wrong(",speed=0"), "from 1 to 1000 "));
    EXPECT_TRUE(contains(wrong(",full=0"), "from 1 to 10000"));
}

TEST_F(Spacenav, renders_no_force_and_says_so) {
    const auto device = open();
    const DeviceInfo info = device->info();
    EXPECT_EQ(info.name, "spacenav");
    EXPECT_FALSE(info.renders_force);
    EXPECT_TRUE(info.has_orientation);
    EXPECT_EQ(info.workspace_low, Vec3(-80, -80, -80));
    EXPECT_EQ(info.workspace_high, Vec3(80, 80, 80));
    device->write({Vec3(1, 2, 3)}, 0);
    device->stop();
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
}

TEST_F(Spacenav, a_puck_at_rest_sends_nothing_and_stays_ready) {
    const auto device = open();
    for (int i = 0; i < 20; ++i) {
        std::this_thread::sleep_for(10ms);
        // A machine that stalls just here is told apart from a device that has gone stale.
        EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
    }
    EXPECT_EQ(device->read(0).position, Vec3(0, 0, 0));
    EXPECT_EQ(daemon_.heard(), 0U);  // protocol 0 needs no word from us
}

TEST_F(Spacenav, the_hand_slides_while_the_puck_is_deflected) {
    const auto device = open(",speed=10");
    daemon_.say({0, 0, 0, -350, 0, 0, 0, 8});
    EXPECT_TRUE(eventually([&] { return device->read(0).position[2] > 1; }));
    daemon_.say({0, 0, 0, 0, 0, 0, 0, 8});
    Vec3 there = Vec3::Zero();
    EXPECT_TRUE(eventually([&] {
        there = device->read(0).position;
        return throughout(50ms, [&] { return device->read(0).position == there; });
    }));
    EXPECT_LT(there[2], 79);  // let go, and not at the wall
    EXPECT_EQ(there[0], 0);
    EXPECT_EQ(there[1], 0);
}

TEST_F(Spacenav, the_hand_turns_and_the_buttons_are_held) {
    const auto device = open(",turn=360");
    daemon_.say({0, 0, 0, 0, 0, 350, 0, 8});
    daemon_.say({1, 1, 0, 0, 0, 0, 0, 0});
    EXPECT_TRUE(eventually([&] { return device->read(0).buttons == 2; }));
    EXPECT_TRUE(eventually([&] { return device->read(0).orientation(0, 2) > 0.1; }));
    daemon_.say({2, 1, 0, 0, 0, 0, 0, 0});
    EXPECT_TRUE(eventually([&] { return device->read(0).buttons == 0; }));
}

TEST_F(Spacenav, the_hand_turns_at_its_speed_until_the_puck_is_let_go_and_keeps_its_place) {
    const auto device = open(",turn=20");
    daemon_.say({0, 0, 0, 0, 350, 0, 0, 8});
    EXPECT_TRUE(eventually([&] { return device->read(0).orientation(2, 1) > 0.05; }));
    daemon_.say({0, 0, 0, 0, 0, 0, 0, 8});
    Mat3 there = Mat3::Identity();
    EXPECT_TRUE(eventually([&] {
        there = device->read(0).orientation;
        return throughout(50ms, [&] { return device->read(0).orientation == there; });
    }));
    EXPECT_EQ(there(0, 0), 1);  // about x alone
    EXPECT_EQ(device->read(0).position, Vec3(0, 0, 0));
}

TEST_F(Spacenav, absurd_rotations_and_other_types_leave_a_rotation) {
    constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    constexpr std::int32_t least = std::numeric_limits<std::int32_t>::min();
    const auto device = open(",turn=360");
    daemon_.say({5, 0, 0, 0, most, most, most, 8});
    EXPECT_TRUE(
        throughout(30ms, [&] { return device->read(0).orientation == Mat3(Mat3::Identity()); }));
    for (const std::int32_t x : {most, least}) {
        daemon_.say({0, 0, 0, 0, x, least, most, x});
        EXPECT_TRUE(throughout(100ms, [&] {
            const Mat3 m = device->read(0).orientation;
            return (m * m.transpose() - Mat3::Identity()).norm() < 1e-9 && m.determinant() > 0;
        }));
    }
    EXPECT_TRUE(eventually([&] { return device->read(0).orientation != Mat3(Mat3::Identity()); }));
}

TEST_F(Spacenav, a_daemon_that_hangs_up_while_the_hand_turns_stops_it) {
    const auto device = open();
    daemon_.say({0, 0, 0, 0, 0, 350, 0, 8});
    ASSERT_TRUE(eventually([&] { return device->read(0).orientation(0, 2) > 0.05; }));
    daemon_.go_away();
    ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
    const Mat3 there = device->read(0).orientation;
    daemon_.listen();
    ASSERT_TRUE(daemon_.accept());
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_TRUE(throughout(50ms, [&] { return device->read(0).orientation == there; }));
}

TEST_F(Spacenav, an_event_may_come_in_pieces) {
    const auto device = open();
    const MockDaemon::Event event{0, 350, 0, 0, 0, 0, 0, 8};
    const char* bytes = reinterpret_cast<const char*>(event.data());
    for (std::size_t i = 0; i + 1 < sizeof event; ++i) {
        daemon_.say_bytes(bytes + i, 1);
        if (i % 8 == 0) std::this_thread::sleep_for(2ms);
    }
    std::this_thread::sleep_for(20ms);
    EXPECT_EQ(device->read(0).position, Vec3(0, 0, 0));
    daemon_.say_bytes(bytes + sizeof event - 1, 1);
    EXPECT_TRUE(eventually([&] { return device->read(0).position[0] > 1; }));
}

TEST_F(Spacenav, garbage_moves_nothing_out_of_its_box_and_stops_nothing) {
    constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    const auto device = open(",speed=1000");
    daemon_.say({77, most, most, most, most, most, most, most});
    daemon_.say({-1, 350, 350, 350, 350, 350, 350, 350});
    daemon_.say({1, 99, 0, 0, 0, 0, 0, 0});
    daemon_.say({0, most, -most, 0, 0, 0, 0, -1});
    EXPECT_TRUE(eventually([&] { return device->read(0).position == Vec3(80, -80, 0); }));
    EXPECT_EQ(device->read(0).buttons, 0U);
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
}

TEST_F(Spacenav, a_daemon_that_hangs_up_is_lost_until_it_is_back_and_the_hand_stays_where_it_was) {
    const auto device = open();
    daemon_.say({0, 350, 0, 0, 0, 0, 0, 8});
    daemon_.say({1, 0, 0, 0, 0, 0, 0, 0});
    ASSERT_TRUE(eventually([&] { return device->read(0).position[0] > 2; }));
    daemon_.say_bytes("half an event", 13);
    daemon_.go_away();
    ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
    EXPECT_TRUE(contains(device->problem(), "closed the connection")) << device->problem();
    const Vec3 there = device->read(0).position;
    EXPECT_TRUE(throughout(50ms, [&] { return device->read(0).position == there; }));

    daemon_.listen();
    ASSERT_TRUE(daemon_.accept());
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_EQ(device->problem(), "");
    EXPECT_EQ(device->read(0).buttons, 0U);
    EXPECT_TRUE(throughout(50ms, [&] { return device->read(0).position == there; }));
    daemon_.say({0, 0, 350, 0, 0, 0, 0, 8});
    EXPECT_TRUE(eventually([&] { return device->read(0).position[1] > 1; }));
    EXPECT_EQ(device->read(0).position[0], there[0]);
}

TEST_F(Spacenav, can_be_closed_while_it_is_lost) {
    auto device = open();
    daemon_.go_away();
    ASSERT_TRUE(becomes(*device, DeviceStatus::lost));
    device.reset();
}

}  // namespace
}  // namespace palpate::devices
