// Rule 2: the running servo thread does not allocate, lock, do I/O or throw.
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
#include "palpate/editor.hpp"
#include "palpate/scenes/motions.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/servo.hpp"
#include "support/allocation_counter.hpp"
#include "support/scripted_device.hpp"

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

/// Threads that observe, record and send commands.
struct Company {
    std::atomic<bool> done{false};
    std::atomic<std::int64_t> seen{0}, recorded{0}, sent{0};
    std::vector<std::jthread> threads;

    Company(Servo& servo, Queue<SessionEvent>& recorder, double isovalue,
            const ForceSettings& force) {
        threads.emplace_back([&] {
            while (!done) seen += servo.snapshot().has_value();
        });
        threads.emplace_back([&] {
            while (!done) {
                if (recorder.pop()) {
                    ++recorded;
                } else {
                    std::this_thread::sleep_for(1ms);
                }
            }
        });
        threads.emplace_back([&, isovalue, force] {
            const Command commands[] = {command::Isovalue{isovalue},
                                        command::Freeze{true},
                                        command::Freeze{false},
                                        command::Scale{1.2},
                                        command::Scale{1},
                                        force,
                                        DeviceTransform{}};
            while (!done) {
                for (const Command& command : commands) sent += servo.send(command);
                std::this_thread::sleep_for(1ms);
            }
        });
    }
    void leave() {
        done = true;
        threads.clear();
    }
};

TEST(Servo, thread_does_not_allocate_lock_call_the_system_or_throw_in_100000_ticks) {
    const auto scene = scenes::make_volume("sphere");
    const Field field(scene.volume);
    ExploringHand hand;
    hand.samples = scenes::make_motion("explore", field, scene.isovalue,
                                       {.rate_hz = 8000, .duration_s = 5, .speed_mm_s = 200});
    ScriptedDevice device([&](double) { return hand.read(); });
    RendererSettings settings;
    settings.device.rate = 8000;
    settings.force.ramp = 0;
    settings.force.magnet = {1, 0.5};
    settings.force.texture = {0.05, 2};
    settings.proxy.friction = {0.3, 0.2};
    settings.penetrability = penetrability_threshold(3, scene.isovalue);
    Queue<SessionEvent> recorder(1024);
    Servo servo(Session{make_renderer(field, scene.isovalue, settings), {.clutch_buttons = 1}},
                device, {.rate = 8000, .recorder = &recorder});

    Company company(servo, recorder, scene.isovalue, settings.force);
    const SystemCount before = system_count();
    servo.start();
    const auto begin = std::chrono::steady_clock::now();
    constexpr std::int64_t wanted = 100'000;
    while (servo.report().ticks < wanted && std::chrono::steady_clock::now() - begin < 120s) {
        std::this_thread::sleep_for(20ms);
    }
    company.leave();
    servo.stop();
    const SystemCount count = system_count();
    const ServoReport report = servo.report();

    EXPECT_GE(report.ticks, wanted);
    EXPECT_EQ(hand.allocations, 0);
    EXPECT_EQ(hand.frees, 0);
    EXPECT_EQ(count.locks, before.locks);
    EXPECT_EQ(count.exceptions, before.exceptions);
    EXPECT_EQ(count.calls, before.calls) << "the last one: " << count.last_call;
    // All of this happened.
    EXPECT_GT(device.largest_force(), 0.5);
    EXPECT_GT(company.seen, 1000);
    EXPECT_GT(company.recorded, wanted / 2);
    EXPECT_GT(company.sent, 100);
}

/// Threads that edit and that push frames: for a loop at 1 kHz 100 and 50 times a second, so 8
/// times as often here. They keep nothing of what they send.
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
                std::this_thread::sleep_for(1250us);
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
                std::this_thread::sleep_for(2500us);
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
    const Field field(smoothed(scene.volume));
    ExploringHand hand;
    hand.samples = scenes::make_motion("explore", field, scene.isovalue,
                                       {.rate_hz = 8000, .duration_s = 5, .speed_mm_s = 200});
    ScriptedDevice device([&](double) { return hand.read(); });
    RendererSettings settings;
    settings.device.rate = 8000;
    settings.force.ramp = 0;
    Queue<SessionEvent> recorder(1024);  // soon full: events that are lost must free nothing
    Servo servo(Session{make_renderer(field, scene.isovalue, settings), {}}, device,
                {.rate = 8000, .recorder = &recorder});
    DataCompany company(servo, field, scene.isovalue);
    const SystemCount before = system_count();
    servo.start();
    const auto begin = std::chrono::steady_clock::now();
    constexpr std::int64_t wanted = 100'000;
    while (servo.report().ticks < wanted && std::chrono::steady_clock::now() - begin < 120s) {
        std::this_thread::sleep_for(20ms);
    }
    company.leave();
    servo.stop();
    const SystemCount count = system_count();

    EXPECT_GE(servo.report().ticks, wanted);
    EXPECT_EQ(hand.allocations, 0);
    EXPECT_EQ(hand.frees, 0);
    EXPECT_EQ(count.locks, before.locks);
    EXPECT_EQ(count.exceptions, before.exceptions);
    EXPECT_EQ(count.calls, before.calls) << "the last one: " << count.last_call;
    std::printf("[ evidence ] %lld ticks, %lld edits, %lld pushed frames\n",
                static_cast<long long>(servo.report().ticks), static_cast<long long>(company.edits),
                static_cast<long long>(company.pushes));
    EXPECT_GT(device.largest_force(), 0.5);
    EXPECT_GT(company.edits, 1000);
    EXPECT_GT(company.pushes, 500);
}

}  // namespace
