// Servo: a device that hangs or throws loses its force and ends the session, not the program; and
// stop() from anywhere. In virtual time; one test of the watchdog's thread at its real pace.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <thread>
#include <vector>

#include "palpate/servo.hpp"
#include "support/eventually.hpp"
#include "support/press.hpp"
#include "support/scripted_device.hpp"
#include "support/stepped_servo.hpp"

using namespace palpate;
using namespace palpate::support;
using namespace std::chrono_literals;

namespace {

/// A device without a thread of its own: what was written last stays on its motors. What happens in
/// one of its calls can be chosen.
class FailingDevice : public Device {
  public:
    enum class Call : std::uint8_t { none, read, write, write_zero };

    /// The next call of this kind does this first.
    void fail(Call call, std::function<void()> how) {
        how_ = std::move(how);
        failed_ = false;
        failing_ = call;
    }

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
        if (when_stopped) when_stopped();
        force_ = 0;
        stopped_ = true;
    }

    std::function<void()> when_stopped;

    double force() const { return force_; }
    bool failed() const { return failed_; }
    bool stopped() const { return stopped_; }
    /// Writes that ended after the failure.
    int late_writes() const { return late_writes_; }

  private:
    void fail_if_asked(Call call) {
        if (call != failing_ || failed_) return;
        failed_ = true;
        how_();
    }

    std::atomic<Call> failing_{Call::none};
    std::function<void()> how_;
    std::atomic<bool> failed_{false}, stopped_{false};
    std::atomic<double> force_{0};
    std::atomic<int> late_writes_{0};
};
using Call = FailingDevice::Call;

Session pressing() {
    return {make_renderer(ramp_field(), 30), {}};
}

/// The behaviour of a thread in a call that does not return.
enum class How : std::uint8_t { waits, spins, throws };

struct FailureCase {
    Call call;
    How how;
};

std::string words_of(const FailureCase& failure) {
    const char* const how[] = {"waits", "spins", "throws"};
    return std::string(failure.call == Call::read ? "read" : "write") + "_" +
           how[static_cast<int>(failure.how)];
}
std::string name_of_case(const testing::TestParamInfo<FailureCase>& info) {
    return words_of(info.param);
}
void PrintTo(const FailureCase& failure, std::ostream* out) {
    *out << words_of(failure);
}

/// Another thread, while this one waits for it.
template <class F>
void elsewhere(F&& act) {
    std::jthread(std::forward<F>(act)).join();
}

/// The watchdog's looks at a call, until the force is gone; how many that took. The first one comes
/// a whole 5 ms after the call began, so that it takes longest.
int looks_at(Servo& servo, const FailingDevice& device, bool spins) {
    std::int64_t cpu = 1'000'000;
    for (int look = 1; look <= 100; ++look) {
        pass(5ms);
        if (spins) cpu += 5'000'000;
        elsewhere([&] { servo.watch(cpu, spins); });
        if (device.stopped()) return look;
    }
    return 0;
}

class ServoFailure : public testing::TestWithParam<FailureCase> {
  protected:
    bool throws() const { return GetParam().how == How::throws; }
};

TEST_P(ServoFailure, takes_the_force_away_and_ends_the_session_not_the_program) {
    FailingDevice device;
    Queue<SessionEvent> recorder(1 << 14);
    Servo servo(pressing(), device, stepped({.recorder = &recorder}));
    EXPECT_EQ(servo.device_failure(), DeviceFailure::none);
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force() > 0.4; }));
    const auto expected = throws() ? DeviceFailure::threw : DeviceFailure::hung;
    device.fail(GetParam().call, [&] {
        if (throws()) throw std::runtime_error("the driver has failed");
        EXPECT_EQ(looks_at(servo, device, GetParam().how == How::spins), 3);
        EXPECT_EQ(device.force(), 0);
        EXPECT_EQ(servo.device_failure(), expected);
        elsewhere([&] { servo.stop(); });  // returns, whatever the device does
    });
    EXPECT_FALSE(tick(servo));
    EXPECT_TRUE(device.stopped());
    EXPECT_EQ(servo.device_failure(), expected);
    EXPECT_STRNE(name_of(expected), "");
    EXPECT_EQ(servo.snapshot()->session.device.status, DeviceStatus::fault);
    EXPECT_TRUE(servo.snapshot()->session.tick.force.isZero(0));
    EXPECT_TRUE(servo.session().past.begun);
    // The call that hung ends as a write, but no other begins.
    const bool one = GetParam().call == Call::write && !throws();
    EXPECT_EQ(device.late_writes(), one ? 1 : 0);
    EXPECT_EQ(device.force(), 0);
    std::int64_t recorded = 0;
    while (recorder.pop()) ++recorded;
    EXPECT_EQ(recorded, servo.report().ticks);
}

INSTANTIATE_TEST_SUITE_P(
    Devices, ServoFailure,
    testing::Values(FailureCase{Call::read, How::waits}, FailureCase{Call::read, How::spins},
                    FailureCase{Call::read, How::throws}, FailureCase{Call::write, How::waits},
                    FailureCase{Call::write, How::spins}, FailureCase{Call::write, How::throws}),
    &name_of_case);

TEST(ServoFailure, a_call_that_hangs_loses_its_force_within_20_ms) {
    FailingDevice device;
    Servo servo(pressing(), device, stepped());
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force() > 0.4; }));
    std::chrono::nanoseconds taken_after{};
    device.fail(Call::read, [&] {
        const std::int64_t begun = virtual_now();
        looks_at(servo, device, false);
        taken_after = passed_since(begun);
    });
    tick(servo);
    EXPECT_EQ(taken_after, 15ms);
}

TEST(ServoFailure, a_call_that_returns_in_time_or_waits_for_a_processor_does_not_hang) {
    FailingDevice device;
    Servo servo(pressing(), device, stepped());
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force() > 0.4; }));
    const auto look = [&](std::int64_t cpu, bool could_run) {
        elsewhere([&] { servo.watch(cpu, could_run); });
    };
    for (int call = 0; call < 10; ++call) {  // each is seen twice
        device.fail(call % 2 ? Call::read : Call::write, [&] {
            look(1'000'000, false);
            look(1'000'000, false);
        });
        EXPECT_TRUE(tick(servo));
        look(1'000'000, false);  // no call is under way
    }
    FailingDevice starved;
    Servo other(pressing(), starved, stepped());
    ASSERT_TRUE(ticks_until(other, [&] { return starved.force() > 0.4; }));
    starved.fail(Call::read, [&] {  // one of many threads on a processor: it hardly runs
        std::int64_t cpu = 0;
        for (int i = 0; i < 40; ++i) other.watch(cpu += 100'000, true);
    });
    EXPECT_TRUE(tick(other));
    EXPECT_EQ(other.device_failure(), DeviceFailure::none);
    EXPECT_EQ(servo.device_failure(), DeviceFailure::none);
}

TEST(ServoFailure, the_zero_at_the_end_may_hang_too) {
    FailingDevice device;
    Servo servo(pressing(), device, stepped());
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force() > 0.4; }));
    device.fail(Call::write_zero, [&] { EXPECT_EQ(looks_at(servo, device, false), 3); });
    servo.stop();
    EXPECT_TRUE(device.failed());
    EXPECT_TRUE(device.stopped());
    EXPECT_EQ(device.force(), 0);
    EXPECT_EQ(servo.device_failure(), DeviceFailure::hung);
}

TEST(PacedWatchdog, its_thread_takes_the_force_of_a_call_that_hangs_within_20_ms) {
    using Clock = std::chrono::steady_clock;
    Clock::duration fastest = Clock::duration::max();  // the machine may stall
    for (int trial = 0; trial < 50 && fastest > 20ms; ++trial) {
        FailingDevice device;
        std::atomic<Clock::time_point> taken{};
        device.when_stopped = [&] { taken = Clock::now(); };
        Servo servo(pressing(), device);
        std::atomic<Clock::time_point> begun{};
        device.fail(trial % 2 ? Call::read : Call::write, [&] {
            begun = Clock::now();
            while (!device.stopped()) std::this_thread::sleep_for(1ms);
        });
        servo.start();
        ASSERT_TRUE(comes_true([&] { return device.stopped(); }));
        servo.stop();
        EXPECT_EQ(servo.device_failure(), DeviceFailure::hung);
        fastest = std::min(fastest, taken.load() - begun.load());
    }
    EXPECT_LE(fastest, 20ms);
}

TEST(ServoStop, any_number_of_threads_stop_it_any_number_of_times) {
    for (int round = 0; round < 20; ++round) {
        FailingDevice device;
        Servo servo(pressing(), device, stepped());
        if (round % 2) run(servo, 1 + round);
        std::vector<std::jthread> threads;
        for (int i = 0; i < 8; ++i) {
            threads.emplace_back([&] {
                servo.stop();
                servo.stop();
            });
        }
        if (round % 2) {
            while (servo.step()) {
            }
        }
        threads.clear();
        EXPECT_EQ(device.force(), 0);
        EXPECT_NO_THROW((void)servo.session());
    }
}

TEST(ServoStop, destroying_it_waits_for_those_that_stop_it) {
    for (int round = 0; round < 20; ++round) {
        FailingDevice device;
        auto servo = std::make_unique<Servo>(pressing(), device, stepped());
        ASSERT_TRUE(ticks_until(*servo, [&] { return device.force() > 0.1; }));
        const std::jthread other([to_stop = servo.get()] { to_stop->stop(); });
        while (servo->step()) {
        }
        servo.reset();  // the other thread is in stop(), or has just left it
        EXPECT_EQ(device.force(), 0);
    }
}

TEST(ServoStop, returns_only_when_the_force_of_a_call_that_hangs_is_gone) {
    FailingDevice device;
    Servo servo(pressing(), device, stepped());
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force() > 0.4; }));
    std::atomic<bool> returned{false};
    std::jthread other;
    device.when_stopped = [&] {
        other = std::jthread([&] {
            servo.stop();
            returned = true;
        });
        std::this_thread::sleep_for(5ms);  // time to return too early
        EXPECT_FALSE(returned);
    };
    device.fail(Call::read, [&] {
        EXPECT_EQ(looks_at(servo, device, false), 3);
        other.join();  // though the call is still under way
        EXPECT_TRUE(returned);
    });
    EXPECT_FALSE(tick(servo));
}

TEST(ServoStop, returns_only_when_the_force_of_a_call_that_hung_and_came_back_is_gone) {
    FailingDevice device;
    Servo servo(pressing(), device, stepped());
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force() > 0.4; }));
    std::atomic<bool> is_stopping{false}, has_returned{false};
    device.when_stopped = [&] {
        is_stopping = true;
        while (!has_returned) std::this_thread::sleep_for(1ms);
        std::this_thread::sleep_for(5ms);  // time to end too early
    };
    std::jthread watchdog, other;
    device.fail(Call::read, [&] {
        watchdog = std::jthread([&] { looks_at(servo, device, false); });
        ASSERT_TRUE(comes_true([&] { return is_stopping.load(); }));
        other = std::jthread([&] {
            servo.stop();
            EXPECT_EQ(device.force(), 0);
        });
        has_returned = true;
    });
    EXPECT_FALSE(tick(servo));
    EXPECT_EQ(device.force(), 0);
    EXPECT_EQ(servo.device_failure(), DeviceFailure::hung);
}

TEST(ServoStop, a_device_may_stop_the_servo_that_reads_it) {
    Servo* self = nullptr;
    bool now = false;
    ScriptedDevice device([&](double time) {
        if (now) self->stop();
        return ready_at(at_depth(29 + std::min(2.0, 20 * time)));
    });
    Servo servo(pressing(), device, stepped());
    self = &servo;
    ASSERT_TRUE(ticks_until(servo, [&] { return device.force().norm() > 0.4; }));
    now = true;
    EXPECT_FALSE(tick(servo));
    EXPECT_EQ(device.force(), Vec3(0, 0, 0));
    servo.stop();
    EXPECT_NO_THROW((void)servo.session());
}

}  // namespace
