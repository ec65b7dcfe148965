// Rule 2: the running servo thread does not allocate, lock, do I/O or throw. Most of its ticks come
// in virtual time, as fast as they can; a few at the real pace of its thread, with the sleep
// between them.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/quiet/system_watch.hpp"
#include "palpate/edit.hpp"
#include "palpate/scenes/motions.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/servo.hpp"
#include "support/allocation_counter.hpp"
#include "support/eventually.hpp"
#include "support/scripted_device.hpp"
#include "support/stepped_servo.hpp"

using namespace palpate;
using namespace palpate::support;
using namespace std::chrono_literals;

namespace {

/// Watches the thread that runs this; a penetrability function or a device runs on the servo's.
template <class F>
SystemCount watched(F&& work) {
    const SystemCount before = system_count();
    std::jthread([&] {
        watch_this_thread();
        work();
        end_watch();
    }).join();
    const SystemCount after = system_count();
    return {after.locks - before.locks, after.exceptions - before.exceptions,
            after.calls - before.calls, after.last_call};
}

TEST(SystemWatch, sees_locks_exceptions_and_files) {
    std::mutex mutex;
    EXPECT_EQ(watched([&] { std::scoped_lock lock(mutex); }).locks, 1);
    EXPECT_EQ(watched([] {
                  try {
                      throw std::runtime_error("seen");
                  } catch (const std::runtime_error&) {
                  }
              }).exceptions,
              1);
    const SystemCount quiet = watched([] {});
    EXPECT_EQ(quiet.locks + quiet.exceptions + quiet.calls, 0);
    bool filtered = false;
    std::jthread([&] { filtered = watch_this_thread(); }).join();
    if (!filtered) GTEST_SKIP() << "the kernel does not let a thread filter its system calls";
    EXPECT_EQ(watched([] { (void)!::open("/dev/null", O_RDONLY); }).calls, 1);
    EXPECT_EQ(watched([] { std::this_thread::sleep_for(1ms); }).calls, 0);
}

/// A hand that repeats the motion `explore` over a volume, and watches the thread that reads it.
struct ExploringHand {
    std::vector<scenes::HandSample> samples;
    std::atomic<std::int64_t> reads{0};
    std::int64_t allocations_before = 0, frees_before = 0;  // the servo thread's
    std::atomic<std::int64_t> allocations{0}, frees{0};

    DeviceReading read() {
        const std::int64_t i = reads.fetch_add(1);
        if (i == 0) {
            watch_this_thread();
            allocations_before = thread_allocation_count();
            frees_before = thread_free_count();
        }
        allocations = thread_allocation_count() - allocations_before;
        frees = thread_free_count() - frees_before;
        const auto count = static_cast<std::int64_t>(samples.size());
        const std::int64_t there_and_back = i % (2 * count - 2);
        const std::int64_t at =
            there_and_back < count ? there_and_back : 2 * count - 2 - there_and_back;
        return ready_at(samples[static_cast<std::size_t>(at)].position);
    }
};

ExploringHand exploring(const Field& field, double isovalue) {
    return {scenes::make_motion("explore", field, isovalue,
                                {.rate_hz = 8000, .duration_s = 5, .speed_mm_s = 200})};
}

void expect_quiet(const ExploringHand& hand, const SystemCount& before) {
    const SystemCount count = system_count();
    EXPECT_EQ(hand.allocations, 0);
    EXPECT_EQ(hand.frees, 0);
    EXPECT_EQ(count.locks, before.locks);
    EXPECT_EQ(count.exceptions, before.exceptions);
    EXPECT_EQ(count.calls, before.calls) << "the last one: " << count.last_call;
}

/// Ticks on a thread of their own, which the hand watches.
template <class Condition>
void step_on_a_thread(Servo& servo, Condition&& enough) {
    std::jthread([&] {
        while (!enough()) run(servo, 1000);
        servo.stop();
    }).join();
}

ForceSettings busy_force(const Servo& servo) {
    return servo.settings().force;
}

/// Threads that observe, record and send commands, and now and then begin another recording.
struct Company {
    std::atomic<bool> done{false};
    std::atomic<std::int64_t> seen{0}, recorded{0}, sent{0}, begun{0};
    std::vector<std::jthread> threads;

    Company(Servo& servo, Queue<SessionEvent>& recorder, double isovalue,
            const ForceSettings& force) {
        threads.emplace_back([&] {
            while (!done) seen += servo.snapshot().has_value();
        });
        threads.emplace_back([&] {
            while (!done) recorded += recorder.pop().has_value();
        });
        threads.emplace_back([&, isovalue, force] {
            int rounds = 0;
            const Command commands[] = {command::Isovalue{isovalue},
                                        command::Freeze{true},
                                        command::Freeze{false},
                                        command::Scale{1.2},
                                        command::Scale{1},
                                        force,
                                        DeviceTransform{}};
            while (!done) {
                for (const Command& command : commands) sent += servo.send(command);
                if (++rounds % 20 == 0) {
                    servo.stop_recording();
                    begun += servo.record(recorder);
                }
                std::this_thread::yield();
            }
        });
    }
    void leave() {
        done = true;
        threads.clear();
    }
};

/// The watched program: a servo with everything on that a tick can do, and all its observers.
struct BusyServo {
    scenes::Scene scene = scenes::make_volume("sphere");
    Field field = linear_field(scene.volume);
    ExploringHand hand = exploring(field, scene.isovalue);
    ScriptedDevice device{[this](double) { return hand.read(); }};
    Queue<SessionEvent> recorder{1024};
    Servo servo;

    explicit BusyServo(ServoSettings settings)
        : servo(
              Session{make_renderer(field, scene.isovalue, busy_settings()), {.clutch_buttons = 1}},
              device, at_8_khz(settings)) {}

    RendererSettings busy_settings() const {
        RendererSettings settings;
        settings.device.rate = 8000;
        settings.force.ramp = 0;
        settings.force.magnet = {1, 0.5};
        settings.force.texture = {0.05, 2};
        settings.proxy.friction = {0.3, 0.2};
        settings.penetrability = penetrability_threshold(3, scene.isovalue);
        return settings;
    }
    ServoSettings at_8_khz(ServoSettings settings) {
        settings.rate = 8000;
        settings.recorder = &recorder;
        return settings;
    }
};

TEST(Servo, thread_does_not_allocate_lock_call_the_system_or_throw_in_100000_ticks) {
    constexpr std::int64_t wanted = 100'000;
    BusyServo busy(stepped());
    Company company(busy.servo, busy.recorder, busy.scene.isovalue, busy_force(busy.servo));
    const SystemCount before = system_count();
    // Until all of this has happened, too.
    const auto enough = [&] {
        return busy.servo.report().ticks >= wanted && company.seen > 1000 &&
               company.recorded > wanted / 2 && company.sent > 100 && company.begun > 10;
    };
    step_on_a_thread(busy.servo, enough);
    company.leave();
    expect_quiet(busy.hand, before);
    EXPECT_GE(busy.servo.report().ticks, wanted);
    EXPECT_GT(busy.device.largest_force(), 0.5);
}

TEST(PacedServo, the_sleep_of_its_thread_is_quiet_too) {
    BusyServo busy({});
    Company company(busy.servo, busy.recorder, busy.scene.isovalue, busy_force(busy.servo));
    const SystemCount before = system_count();
    busy.servo.start();
    EXPECT_TRUE(comes_true([&] { return busy.servo.report().ticks >= 4000; }));
    company.leave();
    busy.servo.stop();
    expect_quiet(busy.hand, before);
}

/// Threads that edit and that push frames, as fast as they can. They keep nothing of what they
/// send.
struct DataCompany {
    std::atomic<bool> done{false};
    std::atomic<std::int64_t> edits{0}, pushes{0}, refused{0};
    std::vector<std::jthread> threads;

    DataCompany(Servo& servo, const Field& field, double isovalue) {
        threads.emplace_back([&, field, isovalue] {
            Editor editor(field.shared_samples(), 1 << 20);
            for (std::uint64_t i = 0; !done; ++i) {
                const auto now = servo.snapshot();
                if (!now) continue;
                const Brush brush = brush_for(i % 64 < 32 ? BrushKind::carve : BrushKind::add,
                                              field, isovalue, 1.5);
                const edit::Stroke stroke{brush, now->session.tick.proxy.scp,
                                          now->session.tick.proxy.hip};
                editor.apply(stroke, i % 16 ? EditStep::same : EditStep::own);
                send(servo, {editor.samples(), 2 * i,
                             std::make_shared<const Recipe>(EditOf{2 * i, stroke})});
                ++edits;
            }
        });
        threads.emplace_back([&, field] {
            for (std::uint64_t i = 0; !done; ++i) {
                // New memory each time: the servo must not be the last to hold it.
                Volume next = smoothed(field.volume());
                Volume first = flattened(Samples(std::move(next)));
                send(servo, {std::make_shared<const Samples>(
                                 std::vector<Frame>{{0, first}, {0.01, smoothed(first)}}, 0.02),
                             2 * i + 1});
                servo.send(command::Speed{i % 3 ? 1.0 : -2.0});
                if (i % 5 == 0) servo.send(command::Moment{0.007});
                ++pushes;
            }
        });
    }
    void send(Servo& servo, const command::Samples& samples) {
        if (!servo.send(samples)) ++refused;
    }
    void leave() {
        done = true;
        threads.clear();
    }
};

TEST(Servo, thread_neither_allocates_nor_frees_nor_locks_while_samples_are_edited_and_pushed) {
    const auto scene = scenes::make_volume("sphere:32x32x32");
    // Of the type that smoothing gives, so that edits and frames take turns on one grid.
    const Field field = linear_field(smoothed(scene.volume));
    ExploringHand hand = exploring(field, scene.isovalue);
    ScriptedDevice device([&](double) { return hand.read(); });
    RendererSettings settings;
    settings.device.rate = 8000;
    settings.force.ramp = 0;
    Queue<SessionEvent> recorder(1024);  // soon full: events that are lost must free nothing
    Servo servo(Session{make_renderer(field, scene.isovalue, settings), {}}, device,
                stepped({.rate = 8000, .recorder = &recorder}));
    DataCompany company(servo, field, scene.isovalue);
    const SystemCount before = system_count();
    constexpr std::int64_t wanted = 100'000;
    const auto enough = [&] {
        return servo.report().ticks >= wanted && company.edits > 1000 && company.pushes > 500;
    };
    step_on_a_thread(servo, enough);
    company.leave();

    EXPECT_GE(servo.report().ticks, wanted);
    expect_quiet(hand, before);
    std::printf("[ evidence ] %lld ticks, %lld edits, %lld pushed frames\n",
                static_cast<long long>(servo.report().ticks), static_cast<long long>(company.edits),
                static_cast<long long>(company.pushes));
    EXPECT_GT(device.largest_force(), 0.5);
}

}  // namespace
