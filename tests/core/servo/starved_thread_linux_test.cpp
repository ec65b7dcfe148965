// Servo: a thread that waits for a processor does not count as one that hangs. Linux, which tells
// them apart.
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <chrono>
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

/// Moves the calling thread to a processor of its choice.
void move_to(const cpu_set_t& processors) {
    ::sched_setaffinity(0, sizeof processors, &processors);
}

TEST(StarvedThread, a_call_that_waits_for_a_processor_does_not_hang) {
    cpu_set_t all, one;
    ::sched_getaffinity(0, sizeof all, &all);
    int processor = 0;
    while (!CPU_ISSET(processor, &all)) ++processor;
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    std::atomic<bool> crowded{false}, over{false};
    ScriptedDevice device([&](double time) {
        if (crowded.exchange(false)) {
            // One thread of many on a processor, and the last in line: it hardly runs.
            const sched_param none{};
            ::pthread_setschedparam(::pthread_self(), SCHED_IDLE, &none);
            move_to(one);
            const auto begin = Clock::now();
            while (Clock::now() - begin < 200ms) {
            }
            over = true;
        }
        return ready_at(at_depth(29 + std::min(2.0, 20 * time)));
    });
    Servo servo({make_renderer(ramp_field(), 30), {}}, device, {.real_time = false});
    servo.start();
    ASSERT_TRUE(comes_true([&] { return device.force().norm() > 0.4; }));
    std::vector<std::jthread> crowd;
    for (int i = 0; i < 3; ++i) {
        crowd.emplace_back([&] {
            move_to(one);
            while (!over) {
            }
        });
    }
    crowded = true;
    ASSERT_TRUE(comes_true([&] { return over.load(); }));
    const std::int64_t then = servo.report().ticks;
    EXPECT_TRUE(comes_true([&] {
        return servo.report().ticks > then + 100 || servo.device_failure() != DeviceFailure::none;
    }));
    EXPECT_EQ(servo.device_failure(), DeviceFailure::none);
}

}  // namespace
