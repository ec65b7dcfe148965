// Servo: a device that hangs or throws loses its force and ends the session, not the program; and
// stop() from anywhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "palpate/servo.hpp"
#include "support/eventually.hpp"
#include "support/press.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;
using namespace std::chrono_literals;

namespace {

using Clock = std::chrono::steady_clock;

/// A device without a thread of its own: what was written last stays on its motors. What happens in
/// its calls can be chosen.
class FailingDevice : public Device {
  public:
    enum class Call : std::uint8_t { none, read, write, write_zero };
    enum class How : std::uint8_t { waits, spins, throws };

    /// The next call of this kind fails.
    void fail(Call call, How how) {
        how_ = how;
        failing_ = call;
    }
    /// Ends a call that waits or spins.
    void wake() { awake_ = true; }

    DeviceInfo info() const override { return {}; }
    DeviceReading read(double time) override {
        fail_if_asked(Call::read);
        return ready_at(at_depth(29 + std::min(2.0, 20 * time)));
    }
    void write(const Wrench& wrench, double) override {
        fail_if_asked(Call::write);
        if (wrench.force.isZero(0)) fail_if_asked(Call::write_zero);
        if (failed_) ++late_writes_;
        if (!stopped_) force_ = wrench.force.norm();
    }
    void stop() noexcept override {
        if (!stopped_.exchange(true)) taken_ = Clock::now();
        force_ = 0;
    }

    double force() const { return force_; }
    bool failed() const { return failed_; }
    bool stopped() const { return stopped_; }
    /// From the beginning of the call that failed until the force was taken away.
    Clock::duration taken_after() const { return taken_.load() - failed_at_.load(); }
    /// Writes that ended after the failure.
    int late_writes() const { return late_writes_; }

  private:
    void fail_if_asked(Call call) {
        if (call != failing_ || failed_) return;
        failed_at_ = Clock::now();
        failed_ = true;
        if (how_ == How::throws) throw std::runtime_error("the driver has failed");
        while (!awake_) {
            if (how_ == How::waits) std::this_thread::sleep_for(1ms);
        }
    }

    std::atomic<Call> failing_{Call::none};
    std::atomic<How> how_{How::waits};
    std::atomic<bool> failed_{false}, awake_{false}, stopped_{false};
    std::atomic<double> force_{0};
    std::atomic<int> late_writes_{0};
    std::atomic<Clock::time_point> failed_at_{}, taken_{};
};

Session pressing() {
    return {make_renderer(ramp_field(), 30), {}};
}

struct FailureCase {
    FailingDevice::Call call;
    FailingDevice::How how;
};

std::string name_of_case(const testing::TestParamInfo<FailureCase>& info) {
    const bool reads = info.param.call == FailingDevice::Call::read;
    const char* const how[] = {"waits", "spins", "throws"};
    return std::string(reads ? "read" : "write") + "_" + how[static_cast<int>(info.param.how)];
}

class ServoFailure : public testing::TestWithParam<FailureCase> {
  protected:
    bool throws() const { return GetParam().how == FailingDevice::How::throws; }
};

TEST_P(ServoFailure, takes_the_force_away_and_ends_the_session_not_the_program) {
    FailingDevice device;
    Queue<SessionEvent> recorder(1 << 14);
    Servo servo(pressing(), device, {.recorder = &recorder});
    servo.start();
    EXPECT_EQ(servo.device_failure(), DeviceFailure::none);
    ASSERT_TRUE(comes_true([&] { return device.force() > 0.4; }));
    device.fail(GetParam().call, GetParam().how);
    ASSERT_TRUE(comes_true([&] { return device.stopped(); }));
    EXPECT_EQ(device.force(), 0);
    const auto expected = throws() ? DeviceFailure::threw : DeviceFailure::hung;
    ASSERT_TRUE(comes_true([&] { return servo.device_failure() == expected; }));
    EXPECT_STRNE(name_of(expected), "");
    servo.stop();  // returns, whatever the device does
    device.wake();
    ASSERT_TRUE(
        comes_true([&] { return servo.snapshot()->session.device.status == DeviceStatus::fault; }));
    EXPECT_TRUE(servo.snapshot()->session.tick.force.isZero(0));
    const auto has_ended = [&] {
        try {
            return servo.session().begun;
        } catch (const std::logic_error&) {
            return false;
        }
    };
    EXPECT_TRUE(comes_true(has_ended));
    // The call that hung may end as a write, but no other begins.
    const bool one = GetParam().call == FailingDevice::Call::write && !throws();
    EXPECT_EQ(device.late_writes(), one ? 1 : 0);
    EXPECT_EQ(device.force(), 0);
    std::int64_t recorded = 0;
    while (recorder.pop()) ++recorded;
    EXPECT_EQ(recorded, servo.report().ticks);
}

INSTANTIATE_TEST_SUITE_P(
    Devices, ServoFailure,
    testing::Values(FailureCase{FailingDevice::Call::read, FailingDevice::How::waits},
                    FailureCase{FailingDevice::Call::read, FailingDevice::How::spins},
                    FailureCase{FailingDevice::Call::read, FailingDevice::How::throws},
                    FailureCase{FailingDevice::Call::write, FailingDevice::How::waits},
                    FailureCase{FailingDevice::Call::write, FailingDevice::How::spins},
                    FailureCase{FailingDevice::Call::write, FailingDevice::How::throws}),
    &name_of_case);

TEST(ServoFailure, a_call_that_hangs_loses_its_force_within_20_ms) {
    Clock::duration fastest = Clock::duration::max();  // the machine may stall
    for (int trial = 0; trial < 50 && fastest > 20ms; ++trial) {
        FailingDevice device;
        Servo servo(pressing(), device);
        servo.start();
        ASSERT_TRUE(comes_true([&] { return device.force() > 0.4; }));
        device.fail(trial % 2 ? FailingDevice::Call::read : FailingDevice::Call::write,
                    FailingDevice::How::waits);
        ASSERT_TRUE(comes_true([&] { return device.stopped(); }));
        fastest = std::min(fastest, device.taken_after());
        device.wake();
    }
    EXPECT_LE(fastest, 20ms);
}

TEST(ServoFailure, the_zero_at_the_end_may_hang_too) {
    FailingDevice device;
    Servo servo(pressing(), device);
    servo.start();
    ASSERT_TRUE(comes_true([&] { return device.force() > 0.4; }));
    device.fail(FailingDevice::Call::write_zero, FailingDevice::How::waits);
    servo.stop();
    EXPECT_TRUE(device.failed());
    EXPECT_TRUE(comes_true([&] { return device.stopped() && device.force() == 0; }));
    EXPECT_EQ(servo.device_failure(), DeviceFailure::hung);
    device.wake();
}

TEST(ServoStop, any_number_of_threads_stop_it_any_number_of_times) {
    for (int round = 0; round < 20; ++round) {
        FailingDevice device;
        Servo servo(pressing(), device);
        if (round % 2) servo.start();
        std::vector<std::jthread> threads;
        for (int i = 0; i < 8; ++i) {
            threads.emplace_back([&] {
                servo.stop();
                servo.stop();
            });
        }
        threads.clear();
        EXPECT_EQ(device.force(), 0);
        EXPECT_NO_THROW((void)servo.session());
    }
}

TEST(ServoStop, destroying_it_waits_for_those_that_stop_it) {
    // A penetrability function that holds the servo thread up, and with it everybody in stop().
    static std::atomic<bool> held, released;
    held = released = false;
    Session session = pressing();
    session.renderer.settings.penetrability = penetrability_threshold(1, 0);
    session.renderer.settings.penetrability.function = [](const Pressing&, const void*) {
        while (held && !released) std::this_thread::sleep_for(1ms);
        return 1.0;
    };
    FailingDevice device;
    auto servo = std::make_unique<Servo>(session, device);
    servo->start();
    ASSERT_TRUE(comes_true([&] { return device.force() > 0.1; }));
    held = true;
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) {
        threads.emplace_back([to_stop = servo.get()] { to_stop->stop(); });
    }
    std::this_thread::sleep_for(200ms);  // all of them are in stop() by then
    threads.emplace_back([] {
        std::this_thread::sleep_for(100ms);
        released = true;
    });
    servo.reset();
    EXPECT_TRUE(released);
    EXPECT_EQ(device.force(), 0);
}

TEST(ServoStop, a_device_may_stop_the_servo_that_reads_it) {
    Servo* self = nullptr;
    std::atomic<bool> now{false};
    ScriptedDevice device([&](double time) {
        if (now) self->stop();
        return ready_at(at_depth(29 + std::min(2.0, 20 * time)));
    });
    Servo servo(pressing(), device);
    self = &servo;
    servo.start();
    ASSERT_TRUE(comes_true([&] { return device.force().norm() > 0.4; }));
    now = true;
    ASSERT_TRUE(comes_true([&] { return device.force().isZero(0); }));
    servo.stop();
    EXPECT_NO_THROW((void)servo.session());
}

}  // namespace
