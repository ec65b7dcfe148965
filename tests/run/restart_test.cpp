// Sessions that start anew on the same device, and devices that hang meanwhile.
#include <atomic>
#include <cmath>

#include "run/run_support.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::run {
namespace {

using support::ScriptedDevice;

/// A setup whose devices are read by `script`.
Setup with_script(std::function<DeviceReading(double)> script) {
    run::Setup setup = test::with_device("simulated");
    setup.field.interpolation = Interpolation::cubic;
    setup.open_device = [script = std::move(script)](const auto&, const auto&) {
        return std::make_unique<ScriptedDevice>(script);
    };
    return setup;
}

/// A hand at a hollow sphere with a wall of 2 mm: device mm are physical mm.
struct AtShell {
    Vec3 hand = Vec3::Zero();
    run::Run live{test::stepped_data(test::loaded("synthetic:shell")),
                  with_script([this](double) { return support::ready_at(hand); })};
    Vec3 centre = physical_from_index(live.field().geometry(), Vec3::Constant(31.5));

    AtShell() {
        go_to(30);
        live.start();
        live.send(DeviceTransform{});
        live.send(command::Isovalue{221.5});
    }
    void go_to(double radius) { hand = centre + Vec3(radius, 0, 0); }
    /// From outside to 3 mm behind the outer side: beyond the wall.
    void press() {
        for (double radius = 30; radius > 20.2; radius -= 0.02) {
            go_to(radius);
            live.step();
        }
        ASSERT_GT(scp(), 22.8);
    }
    double scp() const { return (live.snapshot()->session.tick.proxy.scp - centre).norm(); }
};

TEST(Restart, the_proxy_stays_before_a_wall_that_the_hand_has_passed) {
    AtShell s;
    s.press();
    const double before = s.scp();
    s.live.use_buttons({});
    s.live.step();
    EXPECT_NEAR(s.scp(), before, 1e-6);
    for (const auto interpolation : {Interpolation::linear, Interpolation::cubic}) {
        s.live.use_field(Solid::above, interpolation);
        for (int i = 0; i < 20; ++i) {
            s.live.step();
            ASSERT_NEAR(s.scp(), before, 0.3) << i;
        }
    }
    s.live.use_field(Solid::below, Interpolation::cubic);  // on the other side there is no place
    s.live.step();
    EXPECT_EQ(s.live.snapshot()->session.tick.proxy.status, UpdateStatus::done);
}

TEST(Restart, a_run_that_was_stopped_never_begins_again) {
    AtShell s;
    s.press();
    s.live.stop();
    const std::int64_t last = s.live.snapshot()->number;
    EXPECT_THROW(s.live.use_device(devices::parse_device("simulated:hand=press")), run::WrongState);
    EXPECT_THROW(s.live.use_buttons({}), run::WrongState);
    EXPECT_THROW(s.live.use_field(Solid::below, Interpolation::cubic), run::WrongState);
    EXPECT_THROW(s.live.step(), run::WrongState);
    EXPECT_EQ(s.live.snapshot()->number, last);
}

TEST(Restart, a_tool_stays_before_a_wall_that_the_hand_has_passed) {
    AtShell s;
    s.live.send(command::UseTool{std::make_shared<const Tool>(rod_tool(2, 1))});
    s.press();
    const double before = s.scp();
    s.live.use_buttons({});
    s.live.step();
    EXPECT_NEAR(s.scp(), before, 1e-6);
    EXPECT_THROW(s.live.use_field(Solid::above, Interpolation::linear), std::invalid_argument);
    s.live.step();
    EXPECT_NEAR(s.scp(), before, 1e-3) << "it has not stopped";
}

TEST(Restart, a_hand_that_stands_still_by_command_stands_still_where_it_was) {
    AtShell s;
    s.press();
    s.live.send(command::Freeze{true});
    s.live.step();
    const Vec3 hip = s.live.snapshot()->session.tick.proxy.hip;
    s.go_to(27);
    s.live.use_buttons({});
    s.live.step();
    EXPECT_TRUE(s.live.frozen());
    EXPECT_TRUE(s.live.snapshot()->session.frozen);
    EXPECT_EQ(s.live.snapshot()->session.tick.proxy.hip, hip);
    s.live.send(command::Freeze{false});
    s.live.send(command::Clutch{true});
    s.live.use_field(Solid::above, Interpolation::linear);
    s.live.step();
    EXPECT_FALSE(s.live.frozen());
    EXPECT_TRUE(s.live.snapshot()->session.clutched);
}

TEST(Restart, all_commands_that_wait_are_carried_out) {
    AtShell s;
    s.live.step();
    for (int i = 0; i < 60; ++i) s.live.send(command::Isovalue{150.0 + i});
    s.live.send(command::Clutch{true});
    test::step(s.live, 2);
    EXPECT_GT(s.live.waiting(), 0);
    s.live.use_buttons({});
    EXPECT_EQ(s.live.waiting(), 0);
    EXPECT_EQ(s.live.isovalue(), 209);
    s.live.step();
    EXPECT_EQ(s.live.snapshot()->session.tick.proxy.isovalue, 209);
    EXPECT_TRUE(s.live.snapshot()->session.clutched);
}

TEST(Restart, what_is_sent_after_the_device_has_failed_counts_in_the_next_session) {
    bool fails = false;
    run::Setup setup = test::with_failing("mouse", fails);
    run::Run live(test::stepped_data(test::loaded("synthetic:sphere:32x32x32")), setup);
    live.start();
    live.step();
    fails = true;
    live.step();
    ASSERT_EQ(live.device_failure(), DeviceFailure::threw);
    live.send(command::Isovalue{77});
    fails = false;
    live.use_buttons({});
    live.step();
    EXPECT_EQ(live.snapshot()->session.tick.proxy.isovalue, 77);
}

TEST(Restart, a_recording_with_a_limit_that_was_lowered_replays) {
    const support::ScratchFolder folder;
    Vec3 hand = Vec3::Zero();
    const auto data = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    run::Run live(data, with_script([&hand](double) { return support::ready_at(hand); }));
    live.record(folder / "a.csv");
    live.start();
    live.send(DeviceTransform{});
    const Vec3 centre = physical_from_index(live.field().geometry(), Vec3::Constant(15.5));
    for (int i = 0; i < 600; ++i) {
        // Deeper and deeper, at last faster than the force may rise after a change.
        hand = centre + Vec3(i < 400 ? 16 - 0.02 * i : 8 - 0.1 * (i % 50), 0, 0);
        if (i > 300 && i % 20 == 0) {
            DeviceLimits limits = live.device().limits;
            limits.warming_time = 60 - 0.05 * i;
            live.send(limits);
        }
        live.step();
    }
    EXPECT_GT(live.snapshot()->session.tick.force.norm(), 0.1);
    EXPECT_EQ(live.stop_recording(), 600);
    io::RecordingReader reader(folder / "a.csv");
    Replay replay(reader, data->loaded(), "a.csv");
    EXPECT_EQ(test::expect_same_again(replay), 600);
}

/// Another device, which cannot tell about itself any more after so many calls.
class Forgetful final : public Device {
  public:
    Forgetful(ScriptedDevice& device, int& calls) : device_(device), calls_(calls) {}
    DeviceInfo info() const override {
        if (calls_-- == 0) throw std::bad_alloc();
        return device_.info();
    }
    DeviceReading read(double time) override { return device_.read(time); }
    void write(const Wrench& wrench, double time) override { device_.write(wrench, time); }
    void stop() noexcept override { device_.stop(); }

  private:
    ScriptedDevice& device_;
    int& calls_;
};

TEST(Restart, a_run_that_cannot_take_the_place_of_another_one_leaves_it_its_force) {
    const auto data = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    Vec3 hand = Vec3::Zero();
    const auto script = [&hand](double) { return support::ready_at(hand); };
    ScriptedDevice device(script), other(script);
    int calls = 1000, other_calls = 1000;
    const auto setup_of = [](ScriptedDevice& opened, int& left) {
        run::Setup setup = test::with_device("simulated");
        setup.open_device = [&](const auto&, const auto&) {
            return std::make_unique<Forgetful>(opened, left);
        };
        return setup;
    };
    run::Run before(data, setup_of(device, calls));
    before.start();
    before.send(DeviceTransform{});
    const Vec3 centre = physical_from_index(before.field().geometry(), Vec3::Constant(15.5));
    const auto presses = [&] {
        for (double radius = 16; radius > 4; radius -= 0.02) {
            hand = centre + Vec3(radius, 0, 0);
            before.step();
        }
        return device.force().norm() > 0.1;
    };
    ASSERT_TRUE(presses());
    int began_anew = 0;
    const auto fails = [&](int after) {  // each call of info() fails once
        other_calls = 1000;
        run::Run next(data, setup_of(other, other_calls));
        other_calls = after;
        try {
            next.start_as(before);
            return false;
        } catch (const std::bad_alloc&) {
        }
        before.step();
        began_anew += before.snapshot()->number == 0;
        EXPECT_TRUE(presses()) << after;
        return true;
    };
    int after = 0;
    while (fails(after)) ++after;
    EXPECT_GT(began_anew, 0);
}

/// The servo has a thread of its own, which is in the driver.
TEST(PacedRestart, a_device_that_hangs_is_not_given_up_before_its_call_returns) {
    std::atomic<bool> hangs{false}, is_open{true};
    run::Setup setup = test::with_device("simulated");
    setup.open_device = [&](const auto& choice, const auto& scene) -> std::unique_ptr<Device> {
        if (choice.name != "simulated") return devices::open_device(choice, scene);
        struct Hanging final : ScriptedDevice {
            std::atomic<bool>& open;
            Hanging(std::function<DeviceReading(double)> script, std::atomic<bool>& is_there)
                : ScriptedDevice(std::move(script)), open(is_there) {}
            ~Hanging() override { open = false; }
        };
        return std::make_unique<Hanging>(
            [&hangs](double) {
                while (hangs) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                return support::ready_at({100, 0, 0});
            },
            is_open);
    };
    run::Run live(std::make_shared<Data>(test::loaded("synthetic:sphere:32x32x32")), setup);
    live.start();
    hangs = true;
    ASSERT_TRUE(test::comes_true([&] { return live.device_failure() == DeviceFailure::hung; }));
    EXPECT_THROW(live.use_device(devices::parse_device("mouse")), devices::DeviceError);
    EXPECT_THROW(live.use_buttons({}), devices::DeviceError);
    EXPECT_THROW(live.use_field(Solid::below, Interpolation::cubic), devices::DeviceError);
    EXPECT_TRUE(is_open);
    hangs = false;
    EXPECT_TRUE(test::comes_true([&] {
        try {
            live.use_device(devices::parse_device("mouse"));
            return true;
        } catch (const devices::DeviceError&) {
            return false;
        }
    }));
    EXPECT_FALSE(is_open);
    EXPECT_TRUE(test::comes_true([&] { return live.snapshot().has_value(); }));
}

}  // namespace
}  // namespace palpate::run
