// The device `spacenav` against a stand-in for the daemon.
#include "devices/spacenav/spacenav.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <thread>

#include "devices/spacenav/mock_daemon.hpp"
#include "devices/stepped_device.hpp"
#include "palpate/devices/devices.hpp"
#include "support/allocation_counter.hpp"
#include "support/eventually.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {
namespace {

using namespace std::chrono_literals;
using support::any_scene;
using support::contains;
using support::message_of;
using support::MockDaemon;
using support::pass;

class Spacenav : public support::SteppedDevice {
  protected:
    void step() override {
        pass(1ms);
        mouse_->step();
    }
    std::unique_ptr<spacenav::Mouse> open(const std::string& options = "") {
        auto mouse = spacenav::open(parse_device("spacenav:socket=" + daemon_.path() + options),
                                    any_scene(), {&support::virtual_now, &support::pass_until});
        mouse_ = mouse.get();
        EXPECT_TRUE(daemon_.accept());
        return mouse;
    }

    MockDaemon daemon_;
    spacenav::Mouse* mouse_ = nullptr;
};

TEST_F(Spacenav, a_daemon_that_is_not_there_is_told_with_every_place_that_was_tried) {
    const auto open_nothing = [](const std::string& options) {
        return message_of<DeviceError>(
            [&] { open_device(parse_device("spacenav" + options), any_scene()); });
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
    const DeviceFinding finding = spacenav::find();
    EXPECT_TRUE(finding.found) << finding.missing;
    EXPECT_EQ(finding.what, "spacenavd at " + daemon_.path());
    EXPECT_TRUE(daemon_.accept());
    const auto device = open_device(parse_device("spacenav"), any_scene());
    EXPECT_EQ(device->info().model, "3D mouse, spacenavd at " + daemon_.path());
    unsetenv("SPNAV_SOCKET");
}

TEST_F(Spacenav, options_that_cannot_be_meant_are_refused) {
    const auto wrong = [&](const std::string& options) {
        return message_of<std::invalid_argument>([&] { open(options); });
    };
    EXPECT_TRUE(contains(wrong(",force=1"), "use one of socket, speed, turn, full"));
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
    step();
    EXPECT_EQ(device->read(0).status, DeviceStatus::ready);
}

TEST_F(Spacenav, a_puck_at_rest_sends_nothing_and_stays_ready) {
    const auto device = open();
    EXPECT_TRUE(throughout(5s, [&] { return device->read(0).status == DeviceStatus::ready; }));
    pass(21ms);  // a thread that stands still
    EXPECT_EQ(device->read(0).status, DeviceStatus::stale);
    EXPECT_EQ(device->read(0).position, Vec3(0, 0, 0));
    EXPECT_EQ(daemon_.heard(), 4U);  // the request for protocol 1, once
}

TEST_F(Spacenav, a_mouse_that_is_unplugged_while_deflected_stops_and_is_told) {
    const auto device = open();
    daemon_.say_bytes(&spacenav::protocol_1, sizeof spacenav::protocol_1);
    daemon_.say({0, 350, 0, 0, 0, 0, 0, 8});
    ASSERT_TRUE(within(1s, [&] { return device->read(0).position[0] > 10; }));
    daemon_.say({3, 1, 0});
    ASSERT_TRUE(within(2ms, [&] { return device->read(0).status == DeviceStatus::lost; }));
    EXPECT_TRUE(contains(device->problem(), "unplugged")) << device->problem();
    const Vec3 left = device->read(0).position;
    EXPECT_TRUE(throughout(1s, [&] { return device->read(0).status == DeviceStatus::lost; }));
    daemon_.say({3, 0, 0});
    ASSERT_TRUE(within(2ms, [&] { return device->read(0).status == DeviceStatus::ready; }));
    EXPECT_EQ(device->read(0).position, left);
    EXPECT_EQ(device->problem(), "");
}

TEST_F(Spacenav, a_second_mouse_goes_on_when_the_first_is_unplugged) {
    const auto device = open();
    daemon_.say_bytes(&spacenav::protocol_1, sizeof spacenav::protocol_1);
    daemon_.say({3, 1, 0});
    ASSERT_TRUE(within(2ms, [&] { return device->read(0).status == DeviceStatus::lost; }));
    daemon_.say({0, 0, 0, 0, 0, 0, 0, 8});  // a daemon may send a puck at rest
    EXPECT_TRUE(throughout(10ms, [&] { return device->read(0).status == DeviceStatus::lost; }));
    daemon_.say({0, 350, 0, 0, 0, 0, 0, 8});
    EXPECT_TRUE(within(2ms, [&] { return device->read(0).status == DeviceStatus::ready; }));
}

TEST_F(Spacenav, the_hand_slides_while_the_puck_is_deflected) {
    const auto device = open(",speed=10");
    daemon_.say({0, 0, 0, -350, 0, 0, 0, 8});
    for (int i = 0; i < 150; ++i) step();
    const Vec3 there = device->read(0).position;
    EXPECT_LE((there - Vec3(0, 0, 1.5)).norm(), 1e-12);
    pass(1s);  // a machine that stalls: the hand does not jump
    step();
    EXPECT_LE((device->read(0).position - Vec3(0, 0, 1.7)).norm(), 1e-12);
    daemon_.say({0, 0, 0, 0, 0, 0, 0, 8});
    EXPECT_TRUE(throughout(
        50ms, [&] { return (device->read(0).position - Vec3(0, 0, 1.7)).norm() < 1e-12; }));
}

TEST_F(Spacenav, the_hand_turns_and_the_buttons_are_held) {
    const auto device = open(",turn=360");
    daemon_.say({0, 0, 0, 0, 0, 350, 0, 8});
    daemon_.say({1, 1, 0, 0, 0, 0, 0, 0});
    step();
    EXPECT_EQ(device->read(0).buttons, 2U);
    for (int i = 1; i < 250; ++i) step();
    EXPECT_NEAR(device->read(0).orientation(0, 2), 1, 1e-9);  // a quarter turn
    daemon_.say({2, 1, 0, 0, 0, 0, 0, 0});
    step();
    EXPECT_EQ(device->read(0).buttons, 0U);
}

TEST_F(Spacenav, the_hand_turns_at_its_speed_until_the_puck_is_let_go_and_keeps_its_place) {
    const auto device = open(",turn=20");
    daemon_.say({0, 0, 0, 0, 350, 0, 0, 8});
    for (int i = 0; i < 1500; ++i) step();
    daemon_.say({0, 0, 0, 0, 0, 0, 0, 8});
    const Mat3 there = device->read(0).orientation;
    EXPECT_NEAR(there(2, 1), 0.5, 1e-9);  // 30 degrees
    EXPECT_TRUE(throughout(50ms, [&] { return device->read(0).orientation == there; }));
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
    EXPECT_NE(device->read(0).orientation, Mat3(Mat3::Identity()));
}

TEST_F(Spacenav, a_daemon_that_hangs_up_while_the_hand_turns_stops_it) {
    const auto device = open();
    daemon_.say({0, 0, 0, 0, 0, 350, 0, 8});
    ASSERT_TRUE(within(100ms, [&] { return device->read(0).orientation(0, 2) > 0.05; }));
    daemon_.go_away();
    step();
    ASSERT_EQ(device->read(0).status, DeviceStatus::lost);
    const Mat3 there = device->read(0).orientation;
    daemon_.listen();
    ASSERT_TRUE(within(251ms, [&] { return device->read(0).status == DeviceStatus::ready; }));
    ASSERT_TRUE(daemon_.accept());
    EXPECT_TRUE(throughout(50ms, [&] { return device->read(0).orientation == there; }));
}

TEST_F(Spacenav, an_event_may_come_in_pieces) {
    const auto device = open();
    const MockDaemon::Event event{0, 350, 0, 0, 0, 0, 0, 8};
    const char* bytes = reinterpret_cast<const char*>(event.data());
    for (std::size_t i = 0; i + 1 < sizeof event; ++i) {
        daemon_.say_bytes(bytes + i, 1);
        if (i % 8 == 0) step();
    }
    step();
    EXPECT_EQ(device->read(0).position, Vec3(0, 0, 0));
    daemon_.say_bytes(bytes + sizeof event - 1, 1);
    step();
    EXPECT_NEAR(device->read(0).position[0], 0.1, 1e-12);
}

TEST_F(Spacenav, garbage_moves_nothing_out_of_its_box_and_stops_nothing) {
    constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    const auto device = open(",speed=1000");
    daemon_.say({77, most, most, most, most, most, most, most});
    daemon_.say({-1, 350, 350, 350, 350, 350, 350, 350});
    daemon_.say({1, 99, 0, 0, 0, 0, 0, 0});
    daemon_.say({0, most, -most, 0, 0, 0, 0, -1});
    EXPECT_TRUE(within(81ms, [&] { return device->read(0).position == Vec3(80, -80, 0); }));
    EXPECT_EQ(device->read(0).buttons, 0U);
    EXPECT_EQ(device->read(0).status, DeviceStatus::ready);
}

TEST_F(Spacenav, a_daemon_that_hangs_up_is_lost_until_it_is_back_and_the_hand_stays_where_it_was) {
    const auto device = open();
    daemon_.say({0, 350, 0, 0, 0, 0, 0, 8});
    daemon_.say({1, 0, 0, 0, 0, 0, 0, 0});
    ASSERT_TRUE(within(25ms, [&] { return device->read(0).position[0] > 2; }));
    daemon_.say_bytes("half an event", 13);
    daemon_.go_away();
    step();  // the half, and then the end
    step();
    ASSERT_EQ(device->read(0).status, DeviceStatus::lost);
    EXPECT_TRUE(contains(device->problem(), "closed the connection")) << device->problem();
    const Vec3 there = device->read(0).position;
    EXPECT_TRUE(throughout(100ms, [&] {
        return device->read(0).position == there && device->read(0).status == DeviceStatus::lost;
    }));

    daemon_.listen();
    // It tries every 250 ms.
    EXPECT_TRUE(throughout(149ms, [&] { return device->read(0).status == DeviceStatus::lost; }));
    ASSERT_TRUE(within(2ms, [&] { return device->read(0).status == DeviceStatus::ready; }));
    ASSERT_TRUE(daemon_.accept());
    EXPECT_EQ(device->problem(), "");
    EXPECT_EQ(device->read(0).buttons, 0U);
    EXPECT_TRUE(throughout(50ms, [&] { return device->read(0).position == there; }));
    daemon_.say({0, 0, 350, 0, 0, 0, 0, 8});
    ASSERT_TRUE(within(15ms, [&] { return device->read(0).position[1] > 1; }));
    EXPECT_EQ(device->read(0).position[0], there[0]);
}

TEST_F(Spacenav, can_be_closed_while_it_is_lost) {
    auto device = open();
    daemon_.go_away();
    step();
    ASSERT_EQ(device->read(0).status, DeviceStatus::lost);
    device.reset();
}

/// The device's thread, at its real pace.
class PacedSpacenav : public Spacenav {};

TEST_F(PacedSpacenav, its_thread_outlives_a_lack_of_memory) {
    auto device = open_device(parse_device("spacenav:socket=" + daemon_.path()), any_scene());
    ASSERT_TRUE(daemon_.accept());
    daemon_.go_away();
    const auto becomes = [&](DeviceStatus status) {
        return support::comes_true([&] { return device->read(0).status == status; });
    };
    EXPECT_TRUE(becomes(DeviceStatus::lost));
    {
        const support::DeniedAllocations words(16, 1 << 20);
        std::this_thread::sleep_for(std::chrono::milliseconds(600));  // two attempts to connect
    }
    daemon_.listen();
    ASSERT_TRUE(daemon_.accept());
    EXPECT_TRUE(becomes(DeviceStatus::ready));
}

TEST_F(PacedSpacenav, its_thread_moves_the_hand_and_connects_again) {
    auto device = open_device(parse_device("spacenav:socket=" + daemon_.path()), any_scene());
    ASSERT_TRUE(daemon_.accept());
    daemon_.say({0, 0, 0, -350, 0, 0, 0, 8});
    EXPECT_TRUE(support::comes_true([&] { return device->read(0).position[2] > 1; }));
    const auto becomes = [&](DeviceStatus status) {
        return support::comes_true([&] { return device->read(0).status == status; });
    };
    daemon_.go_away();
    EXPECT_TRUE(becomes(DeviceStatus::lost));
    daemon_.listen();
    ASSERT_TRUE(daemon_.accept());
    EXPECT_TRUE(becomes(DeviceStatus::ready));
}

}  // namespace
}  // namespace palpate::devices
