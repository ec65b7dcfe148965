// The device `falcon` on a stand-in for libftdi with a Falcon behind it, stepped in virtual time.
#include "devices/falcon/falcon.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/blocked_driver.hpp"
#include "devices/claim.hpp"
#include "devices/falcon/kinematics.hpp"
#include "devices/falcon/mock_ftdi.hpp"
#include "devices/stepped_device.hpp"
#include "devices/vendor_library.hpp"
#include "support/eventually.hpp"
#include "support/random.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::devices {
namespace {

using namespace std::chrono_literals;
using support::any_scene;
using support::contains;
using support::message_of;
using support::MockFtdi;
using support::MockFtdiState;
using support::pass;

class Falcon : public support::SteppedDevice {
  protected:
    template <class F>
    auto with(F act) const {
        const std::lock_guard lock(mock_->mutex);
        return act(mock_->state);
    }
    Falcon() {
        MockFtdi* (*plug_in)() = nullptr;
        VendorLibrary({MOCK_FTDI}, "build it").need(plug_in, "mock_ftdi");
        mock_ = plug_in();
        with([](auto& falcon) {
            falcon = MockFtdiState{};
            falcon.while_waiting = [](int ms) { pass(std::chrono::milliseconds(ms)); };
        });
        hold(Vec3::Zero());
    }
    ~Falcon() override {
        with([](auto& falcon) { EXPECT_EQ(falcon.contexts, 0); });
    }

    void step() override {
        device_->step();
        pass(1ms);
    }
    std::unique_ptr<falcon::FalconDevice> open(const std::string& options = "", double rate = 1000,
                                               const OnProgress& progress = {}) {
        DeviceScene scene = any_scene(rate);
        scene.progress = progress;
        auto device =
            falcon::open(parse_device("falcon:library=" + std::string(MOCK_FTDI) + options), scene,
                         {&support::virtual_now, &support::pass_until});
        device_ = device.get();
        return device;
    }
    std::string refusal(const std::string& options = "") {
        return message_of<DeviceError>([&] { open(options); });
    }
    /// The person holds the grip there [device mm].
    void hold(const Vec3& position) {
        const auto angles = falcon::angles_at(falcon::centre + 1e-3 * position);
        const Eigen::Vector3i encoders = falcon::encoders_at(angles.value());
        with([&](auto& falcon) { falcon.encoders = {encoders[0], encoders[1], encoders[2]}; });
    }
    /// [N] that the motors give where the grip is held.
    Vec3 force() const {
        const auto state = with([](auto& falcon) { return falcon; });
        const Vec3 torques = -1e-4 * Vec3(state.motors[0], state.motors[1], state.motors[2]);
        const Vec3 angles =
            falcon::angles_from({state.encoders[0], state.encoders[1], state.encoders[2]});
        const Vec3 place = falcon::position_with(angles, falcon::centre).value();
        return falcon::angle_gradients(place)->transpose() * torques;
    }
    bool becomes(DeviceStatus status, std::chrono::milliseconds time = 1ms) {
        return within(time, [&] { return device_->read(0).status == status; });
    }
    bool presses(const Vec3& newtons) {
        return within(
            30ms, [&] { return (force() - newtons).norm() < 0.01; },
            [&] {
                device_->write({newtons, Vec3::Zero()}, 0);
            });
    }

    falcon::FalconDevice* device_ = nullptr;
    MockFtdi* mock_ = nullptr;
};

TEST_F(Falcon, tells_where_its_grip_is_held) {
    const auto device = open();
    support::Random random(1);
    ASSERT_TRUE(becomes(DeviceStatus::ready));
    for (int i = 0; i < 200; ++i) {
        const Vec3 place = random.point(-40, 40);
        hold(place);
        step();
        const DeviceReading reading = device->read(0);
        ASSERT_EQ(reading.status, DeviceStatus::ready);
        ASSERT_LT((reading.position - place).norm(), 0.1) << place.transpose();
    }
    with([](auto& falcon) { falcon.buttons = 5; });
    step();
    EXPECT_EQ(device->read(0).buttons, 5U);
    EXPECT_EQ(device->info().buttons, 4);
    EXPECT_EQ(device->info().limits.maximum_force, 8);
    with([](auto& falcon) { EXPECT_EQ(falcon.bad_packets, 0); });
}

TEST_F(Falcon, an_opening_that_is_stopped_is_left_alone_and_closed_at_its_end) {
    support::expect_a_stopped_opening_is_left_alone(
        [&](const OnProgress& progress) { return open("", 1000, progress); },
        [&](const auto& block) { with([&](auto& falcon) { falcon.while_opening = block; }); });
}

TEST_F(Falcon, gives_the_force_that_is_written_and_none_after_20_ms_without) {
    const auto device = open();
    for (const Vec3& place : {Vec3(0, 0, 0), Vec3(20, -10, 15), Vec3(-30, 20, -20)}) {
        hold(place);
        for (const Vec3& newtons :
             {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(-1, 2, 0.5)}) {
            EXPECT_TRUE(presses(newtons)) << force().transpose();
        }
    }
    EXPECT_TRUE(throughout(19ms, [&] { return force().norm() > 1; }));
    EXPECT_TRUE(within(3ms, [&] { return force().isZero(0); }));
}

TEST_F(Falcon, asks_no_motor_for_too_much_and_keeps_the_direction) {
    const auto device = open();
    hold(Vec3(30, 30, -30));
    ASSERT_TRUE(becomes(DeviceStatus::ready));
    throughout(
        40ms, [] { return true; },
        [&] {
            device->write({Vec3(0, 0, 1e6), {}}, 0);
        });
    const Vec3 most = force();
    EXPECT_GT(most.norm(), 1);
    EXPECT_LE(most.norm(), 8.01);
    EXPECT_GT(most.normalized()[2], 0.999);
    const int largest = with([](auto& falcon) { return falcon.largest_motor; });
    EXPECT_LE(largest, falcon::most_of_motor);
}

TEST_F(Falcon, stop_ends_the_force_and_so_does_the_end_of_the_device) {
    auto device = open();
    ASSERT_TRUE(presses(Vec3(1, 0, 0)));
    device->stop();
    EXPECT_TRUE(device->is_stopping());
    device->write({Vec3(1, 0, 0), {}}, 0);
    step();
    EXPECT_TRUE(force().isZero(0));
    step();
    EXPECT_FALSE(device->is_stopping());
    device.reset();
    device = open();
    ASSERT_TRUE(presses(Vec3(1, 0, 0)));
    device.reset();
    EXPECT_TRUE(force().isZero(0));
}

TEST_F(Falcon, that_is_not_homed_is_not_felt_until_it_is) {
    with([](auto& falcon) { falcon.is_homed = false; });
    const auto device = open();
    ASSERT_TRUE(becomes(DeviceStatus::uncalibrated));
    EXPECT_TRUE(contains(device->problem(), "pull the grip out"));
    with([](auto& falcon) { EXPECT_EQ(falcon.lights, falcon::red); });
    EXPECT_FALSE(presses(Vec3(1, 0, 0)));
    with([](auto& falcon) { falcon.is_homed = true; });
    EXPECT_TRUE(becomes(DeviceStatus::ready));
    EXPECT_TRUE(presses(Vec3(1, 0, 0)));
    with([](auto& falcon) { EXPECT_EQ(falcon.lights, falcon::green); });
    // It is asked for that only once: the marks are passed again and again.
    with([](auto& falcon) { falcon.is_homed = false; });
    EXPECT_TRUE(throughout(50ms, [&] { return device->read(0).status == DeviceStatus::ready; }));
}

TEST_F(Falcon, that_was_switched_on_gets_the_firmware_of_its_owner) {
    const support::ScratchFolder folder;
    const std::string file = (folder / "falcon.bin").string();
    std::string bytes;
    for (int i = 0; i < 1000; ++i) bytes += static_cast<char>(i * 7);
    support::put_bytes(folder / "falcon.bin", bytes);
    with([](auto& falcon) { falcon.firmware_size = 1000; });
    {
        const auto device = open();
        ASSERT_TRUE(becomes(DeviceStatus::fault));
        EXPECT_TRUE(contains(device->problem(), "firmware=PATH")) << device->problem();
    }
    {
        with([](auto& falcon) { falcon.failing_loads = 2; });
        const auto device = open(",firmware=" + file);
        EXPECT_TRUE(becomes(DeviceStatus::ready));
        with([](auto& falcon) { EXPECT_EQ(falcon.loads, 3); });
        EXPECT_EQ(device->problem(), "");
    }
}

TEST_F(Falcon, whose_firmware_fails_again_and_again_is_tried_a_bounded_number_of_times) {
    const support::ScratchFolder folder;
    support::put_bytes(folder / "falcon.bin", std::string(500, 'x'));
    const std::string option = ",firmware=" + (folder / "falcon.bin").string();
    with([](auto& falcon) {
        falcon.firmware_size = 500;
        falcon.failing_loads = 1000;
    });
    {
        const auto device = open(option);
        ASSERT_TRUE(becomes(DeviceStatus::fault));
        with([](auto& falcon) { EXPECT_EQ(falcon.loads, 3); });
        EXPECT_TRUE(contains(device->problem(), "came back wrong")) << device->problem();
        throughout(900ms, [] { return true; });
        with([](auto& falcon) { EXPECT_EQ(falcon.loads, 3); });
        with([](auto& falcon) { falcon.failing_loads = 0; });
        EXPECT_TRUE(becomes(DeviceStatus::ready, 300ms));
    }
    with([](auto& falcon) {
        falcon.firmware_size = 500;
        falcon.loader_is_dead = true;
    });
    const auto device = open(option);
    ASSERT_TRUE(becomes(DeviceStatus::fault));
    EXPECT_TRUE(contains(device->problem(), "loader does not answer")) << device->problem();
}

TEST_F(Falcon, answers_in_pieces_and_among_noise_are_understood) {
    with([](auto& falcon) {
        falcon.noise = "AB<CD>\x01";
        falcon.split = 3;
    });
    const auto device = open();
    ASSERT_TRUE(becomes(DeviceStatus::ready, 5ms));
    EXPECT_TRUE(throughout(50ms, [&] { return device->read(0).status != DeviceStatus::lost; }));
}

TEST_F(Falcon, a_few_missing_answers_are_borne_and_many_end_the_force) {
    const auto device = open();
    ASSERT_TRUE(presses(Vec3(1, 0, 0)));
    with([](auto& falcon) { falcon.silent_packets = 1; });
    step();
    step();
    EXPECT_EQ(device->read(0).status, DeviceStatus::ready);
    with([](auto& falcon) { falcon.silent_packets = 1 << 20; });
    EXPECT_TRUE(becomes(DeviceStatus::stale, 30ms));
    EXPECT_TRUE(becomes(DeviceStatus::lost, 100ms));
    EXPECT_TRUE(contains(device->problem(), "stopped answering"));
    const long packets = with([](auto& falcon) { return falcon.packets; });
    throughout(500ms, [] { return true; });
    with([&](auto& falcon) { EXPECT_EQ(falcon.packets, packets); });
    with([](auto& falcon) { falcon.silent_packets = 0; });
    EXPECT_TRUE(becomes(DeviceStatus::ready, 700ms));
    EXPECT_TRUE(force().isZero(0));
    EXPECT_TRUE(presses(Vec3(1, 0, 0)));
}

TEST_F(Falcon, an_answer_that_comes_late_is_not_taken_for_that_of_the_next_packet) {
    const auto device = open();
    with([](auto& falcon) { falcon.answers_after = 1; });
    ASSERT_TRUE(becomes(DeviceStatus::ready, 5ms));
    with([](auto& falcon) { falcon.answers_after = 5; });  // just after it was given up
    step();
    with([](auto& falcon) { falcon.answers_after = 1; });
    for (const Vec3& place : {Vec3(10, 0, 0), Vec3(0, 20, 0), Vec3(0, 0, -20)}) {
        hold(place);
        step();
        EXPECT_LT((device->read(0).position - place).norm(), 0.1);
    }
}

TEST_F(Falcon, that_is_unplugged_while_pressed_is_lost_and_comes_back) {
    const auto device = open();
    ASSERT_TRUE(presses(Vec3(1, 0, 0)));
    with([](auto& falcon) { falcon.is_unplugged = true; });
    EXPECT_TRUE(becomes(DeviceStatus::lost));
    EXPECT_TRUE(contains(device->problem(), "device disconnected")) << device->problem();
    const int opens = with([](auto& falcon) { return falcon.opens; });
    throughout(5s, [] { return true; });
    with([&](auto& falcon) { EXPECT_LE(falcon.opens, opens + 5); });
    with([](auto& falcon) { falcon.is_unplugged = false; });
    EXPECT_TRUE(becomes(DeviceStatus::ready, 1100ms));
    EXPECT_TRUE(presses(Vec3(1, 0, 0)));
}

TEST_F(Falcon, angles_that_fit_no_position_are_a_fault_without_force) {
    const auto device = open();
    ASSERT_TRUE(presses(Vec3(1, 0, 0)));
    with([](auto& falcon) { falcon.encoders = {30000, -30000, 30000}; });
    EXPECT_TRUE(becomes(DeviceStatus::fault));
    device->write({Vec3(1, 0, 0), {}}, 0);
    step();
    with([](auto& falcon) { EXPECT_EQ(falcon.motors, (std::array<int, 3>{})); });
    hold(Vec3::Zero());
    EXPECT_TRUE(becomes(DeviceStatus::ready));
}

TEST_F(Falcon, serves_one_hand_which_lets_go_of_it_before_it_is_opened_again) {
    const int hands[2] = {};
    std::unique_ptr<Device> held;
    const auto open_by = [&](const int& hand) {
        const OpenedBy opened_by(&hand, [&] { held.reset(); });
        held = open();
    };
    open_by(hands[0]);
    EXPECT_THROW(open_by(hands[1]), DeviceError);
    ASSERT_TRUE(held);
    {
        const OpenedBy cannot_close(&hands[0], {});
        EXPECT_THROW(open(), DeviceError);
    }
    open_by(hands[0]);
    EXPECT_EQ(with([](auto& falcon) { return falcon.contexts; }), 1);
}

TEST_F(Falcon, that_is_not_there_or_taken_is_refused_with_a_remedy) {
    EXPECT_TRUE(contains(refusal(",firmware=/nowhere/falcon.bin"), "firmware=/nowhere"));
    EXPECT_TRUE(contains(refusal(",index=1"), "no device with index=1 (1 found)"));
    with([](auto& falcon) { falcon.refuses_open = true; });
    EXPECT_TRUE(contains(refusal(), "does another program use it?"));
    with([](auto& falcon) { falcon.count = 0; });
    EXPECT_TRUE(contains(refusal(), "(0 found)"));
    EXPECT_FALSE(falcon::find(MOCK_FTDI).found);
    with([](auto& falcon) { falcon.count = 2; });
    const DeviceFinding found = falcon::find(MOCK_FTDI);
    EXPECT_TRUE(found.found);
    EXPECT_TRUE(contains(found.what, "2 devices"));
    const DeviceFinding none = falcon::find("/nowhere/libftdi1.so.2");
    // The package of Debian, or the file on Windows.
    EXPECT_TRUE(contains(none.missing, "libftdi1-2") || contains(none.missing, "libftdi1.dll"))
        << none.missing;
}

TEST(FalconLibrary, of_the_system_has_every_function_if_it_is_installed) {
    const DeviceFinding finding = falcon::find("");
    EXPECT_FALSE(contains(finding.missing, "has no function")) << finding.missing;
}

class PacedFalcon : public Falcon {};

TEST_F(PacedFalcon, its_thread_presses_until_it_is_closed) {
    with([](auto& falcon) { falcon.while_waiting = nullptr; });
    auto device =
        open_falcon(parse_device("falcon:library=" + std::string(MOCK_FTDI)), any_scene());
    EXPECT_TRUE(support::comes_true([&] {
        device->write({Vec3(1, 0, 0), Vec3::Zero()}, 0);
        return (force() - Vec3(1, 0, 0)).norm() < 0.01;
    }));
    EXPECT_TRUE(support::comes_true([&] { return force().isZero(0); }));  // the servo is silent
    device.reset();
    EXPECT_TRUE(force().isZero(0));
}

}  // namespace
}  // namespace palpate::devices
