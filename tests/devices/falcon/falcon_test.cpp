// The device `falcon` on a stand-in for libftdi with a Falcon behind it, stepped in virtual time.
#include "devices/falcon/falcon.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/falcon/kinematics.hpp"
#include "devices/falcon/mock_ftdi.hpp"
#include "devices/vendor_cases.hpp"
#include "support/random.hpp"

namespace palpate::devices {
namespace {

using support::MockFtdiState;

class Falcon : public VendorDevice<MockFtdiState> {
  protected:
    // For cases that all vendors share.
    static constexpr const char* library = MOCK_FTDI;
    static constexpr const char* lacking = MOCK_FTDI_LACKING;
    static constexpr const char* lacks = "ftdi_setrts";
    static constexpr const char* install = "libftdi1";
    static constexpr const char* words_of_break = "device disconnected";
    static constexpr bool comes_back = true;
    static DeviceFinding find(const std::string& path) { return falcon::find(path); }

    /// Its motors round a force.
    Falcon()
        : VendorDevice("falcon", "mock_ftdi",
                       {.step = 1ms, .soon = 1ms, .felt = 30ms, .rounding = 0.01}) {
        use(library);
        with([](auto& falcon) {
            falcon.while_waiting = [](int ms) { pass(std::chrono::milliseconds(ms)); };
        });
        hold(Vec3::Zero());
    }
    ~Falcon() override { EXPECT_FALSE(is_open()); }

    void step() override {
        device_->step();
        pass(1ms);
    }
    std::unique_ptr<Device> open_for(const DeviceChoice& choice,
                                     const DeviceScene& scene) override {
        auto device = falcon::open(choice, scene, {&support::virtual_now, &support::pass_until});
        device_ = device.get();
        return device;
    }
    /// The person holds the grip there [device mm].
    void hold(const Vec3& position) {
        const auto angles = falcon::angles_at(falcon::centre + 1e-3 * position);
        const Eigen::Vector3i encoders = falcon::encoders_at(angles.value());
        with([&](auto& falcon) { falcon.encoders = {encoders[0], encoders[1], encoders[2]}; });
    }
    /// Where the grip is held.
    Vec3 force() const override {
        const auto state = with([](auto& falcon) { return falcon; });
        const Vec3 torques = -1e-4 * Vec3(state.motors[0], state.motors[1], state.motors[2]);
        const Vec3 angles =
            falcon::angles_from({state.encoders[0], state.encoders[1], state.encoders[2]});
        const Vec3 place = falcon::position_with(angles, falcon::centre).value();
        return falcon::angle_gradients(place)->transpose() * torques;
    }
    bool is_open() const {
        return with([](auto& falcon) { return falcon.contexts != 0; });
    }
    void break_connection(bool on) {
        with([&](auto& falcon) { falcon.is_unplugged = on; });
    }
    void let_time_pass_by_itself() {
        with([](auto& falcon) { falcon.while_waiting = nullptr; });
    }

  private:
    falcon::FalconDevice* device_ = nullptr;
};
INSTANTIATE_TYPED_TEST_SUITE_P(Falcon, Vendor, Falcon);
INSTANTIATE_TYPED_TEST_SUITE_P(Paced, ThreadOf, Falcon);

TEST_F(Falcon, tells_where_its_grip_is_held) {
    const auto device = open();
    support::Random random(1);
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
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

TEST_F(Falcon, gives_the_force_that_is_written_wherever_its_grip_is_held) {
    const auto device = open();
    for (const Vec3& place : {Vec3(0, 0, 0), Vec3(20, -10, 15), Vec3(-30, 20, -20)}) {
        hold(place);
        for (const Vec3& newtons :
             {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(-1, 2, 0.5)}) {
            EXPECT_TRUE(presses(*device, newtons)) << force().transpose();
        }
    }
}

TEST_F(Falcon, asks_no_motor_for_too_much_and_keeps_the_direction) {
    const auto device = open();
    hold(Vec3(30, 30, -30));
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready));
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

TEST_F(Falcon, that_is_not_homed_is_not_felt_until_it_is) {
    with([](auto& falcon) { falcon.is_homed = false; });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::uncalibrated));
    EXPECT_TRUE(contains(device->problem(), "pull the grip out"));
    with([](auto& falcon) { EXPECT_EQ(falcon.lights, falcon::red); });
    EXPECT_FALSE(presses(*device));
    with([](auto& falcon) { falcon.is_homed = true; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
    EXPECT_TRUE(presses(*device));
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
        ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
        EXPECT_TRUE(contains(device->problem(), "firmware=PATH")) << device->problem();
    }
    {
        with([](auto& falcon) { falcon.failing_loads = 2; });
        const auto device = open(",firmware=" + file);
        EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
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
        ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
        with([](auto& falcon) { EXPECT_EQ(falcon.loads, 3); });
        EXPECT_TRUE(contains(device->problem(), "came back wrong")) << device->problem();
        throughout(900ms, [] { return true; });
        with([](auto& falcon) { EXPECT_EQ(falcon.loads, 3); });
        with([](auto& falcon) { falcon.failing_loads = 0; });
        EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 300ms));
    }
    with([](auto& falcon) {
        falcon.firmware_size = 500;
        falcon.loader_is_dead = true;
    });
    const auto device = open(option);
    ASSERT_TRUE(becomes(*device, DeviceStatus::fault));
    EXPECT_TRUE(contains(device->problem(), "loader does not answer")) << device->problem();
}

TEST_F(Falcon, answers_in_pieces_and_among_noise_are_understood) {
    with([](auto& falcon) {
        falcon.noise = "AB<CD>\x01";
        falcon.split = 3;
    });
    const auto device = open();
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready, 5ms));
    EXPECT_TRUE(throughout(50ms, [&] { return device->read(0).status != DeviceStatus::lost; }));
}

TEST_F(Falcon, a_few_missing_answers_are_borne_and_many_end_the_force) {
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& falcon) { falcon.silent_packets = 1; });
    step();
    step();
    EXPECT_EQ(device->read(0).status, DeviceStatus::ready);
    with([](auto& falcon) { falcon.silent_packets = 1 << 20; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::stale, 30ms));
    EXPECT_TRUE(becomes(*device, DeviceStatus::lost, 100ms));
    EXPECT_TRUE(contains(device->problem(), "stopped answering"));
    const long packets = with([](auto& falcon) { return falcon.packets; });
    throughout(500ms, [] { return true; });
    with([&](auto& falcon) { EXPECT_EQ(falcon.packets, packets); });
    with([](auto& falcon) { falcon.silent_packets = 0; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 700ms));
    EXPECT_TRUE(force().isZero(0));
    EXPECT_TRUE(presses(*device));
}

TEST_F(Falcon, an_answer_that_comes_late_is_not_taken_for_that_of_the_next_packet) {
    const auto device = open();
    with([](auto& falcon) { falcon.answers_after = 1; });
    ASSERT_TRUE(becomes(*device, DeviceStatus::ready, 5ms));
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
    ASSERT_TRUE(presses(*device));
    with([](auto& falcon) { falcon.is_unplugged = true; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::lost));
    const int opens = with([](auto& falcon) { return falcon.opens; });
    throughout(5s, [] { return true; });
    with([&](auto& falcon) { EXPECT_LE(falcon.opens, opens + 5); });
    with([](auto& falcon) { falcon.is_unplugged = false; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready, 1100ms));
    EXPECT_TRUE(presses(*device));
}

TEST_F(Falcon, angles_that_fit_no_position_are_a_fault_without_force) {
    const auto device = open();
    ASSERT_TRUE(presses(*device));
    with([](auto& falcon) { falcon.encoders = {30000, -30000, 30000}; });
    EXPECT_TRUE(becomes(*device, DeviceStatus::fault));
    device->write({Vec3(1, 0, 0), {}}, 0);
    step();
    with([](auto& falcon) { EXPECT_EQ(falcon.motors, (std::array<int, 3>{})); });
    hold(Vec3::Zero());
    EXPECT_TRUE(becomes(*device, DeviceStatus::ready));
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
}

}  // namespace
}  // namespace palpate::devices
