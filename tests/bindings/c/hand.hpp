// A device of the caller's that touches the ball, and runs with it, for tests of the C interface.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "support/eventually.hpp"
#include "tests/bindings/c/ball.hpp"

namespace palpate::c::test {

using support::comes_true;

/// Where a callback waits until the test lets it go.
struct Gate {
    std::atomic<bool> closed{false}, reached{false};
    void pass() {
        while (closed) {
            reached = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
};

/// A hand that moves along z from 24 to 12 mm (device axes: +z is towards the person) and stays. If
/// it feels nothing there it comes anew, because a force begins small: after a stall of the machine
/// there is none deep inside.
struct Hand {
    std::atomic<double> depth{24}, step{-0.02};
    std::atomic<double> force{0}, largest{0};
    std::atomic<int> reads{0}, closes{0};
    std::atomic<bool> lost{false};
    std::atomic<std::thread::id> thread;
    std::atomic<palpate_run*> asked{nullptr};  ///< by read(), until it is refused
    std::atomic<bool> refused{false};
    Gate in_read, in_write;  ///< while there is a force
    /// Numbers of the pose that are not finite.
    std::atomic<double> broken_position{0}, broken_orientation{0};
};

inline int32_t read_hand(palpate_reading* reading, void* context) {
    auto& hand = *static_cast<Hand*>(context);
    hand.thread = std::this_thread::get_id();
    if (hand.force > 0.5) hand.in_read.pass();
    const double now = hand.depth;
    const bool inside = now <= 12;
    if (inside && hand.force == 0) hand.step = 0.02;
    if (now >= 24) hand.step = -0.02;
    if (!inside || hand.step > 0) hand.depth = now + hand.step;
    reading->status = PALPATE_DEVICE_READY;
    reading->position[2] = now;
    reading->opening = 0.25;
    reading->position[0] = hand.broken_position;
    reading->orientation[1] = hand.broken_orientation;
    ++hand.reads;
    for (palpate_run* run = hand.asked; run && hand.asked && !hand.refused;) {
        PALPATE_STRUCT(palpate_snapshot, snapshot);
        hand.refused = palpate_run_snapshot(run, &snapshot) == PALPATE_WRONG_STATE;
    }
    return hand.lost;
}

inline int32_t write_hand(const palpate_wrench* wrench, void* context) {
    auto& hand = *static_cast<Hand*>(context);
    const double force = std::hypot(wrench->force[0], wrench->force[1], wrench->force[2]);
    hand.force = force;
    if (force > hand.largest) hand.largest = force;
    if (force > 0.5) hand.in_write.pass();
    return 0;
}

inline void close_hand(void* context) {
    ++static_cast<Hand*>(context)->closes;
}

inline palpate_own_device device_of(Hand& hand) {
    PALPATE_STRUCT(palpate_own_device, own);
    own.maximum_force = 2;
    own.stiffness = 0.5;
    own.read = &read_hand;
    own.write = &write_hand;
    own.close = &close_hand;
    own.context = &hand;
    return own;
}

class CRun : public testing::Test {
  protected:
    ~CRun() override {
        palpate_run_destroy(run_);
        palpate_data_destroy(data_);
    }

    void SetUp() override {
        palpate_volume* volume = ball();
        ASSERT_EQ(palpate_data_create(volume, &data_), PALPATE_OK);
        palpate_volume_destroy(volume);
    }
    palpate_status create(const palpate_own_device* own, const char* device = nullptr) {
        PALPATE_STRUCT(palpate_render_options, render);
        render.has_isovalue = 1;
        render.isovalue = 100;
        render.scale = 1;
        render.stiffness = stiffness_;
        PALPATE_STRUCT(palpate_run_options, options);
        options.render = &render;
        options.own = own;
        options.device = device;
        options.no_real_time = 1;
        return palpate_run_create(data_, &options, &run_);
    }
    void start(const palpate_own_device& own) {
        ASSERT_EQ(create(&own), PALPATE_OK) << palpate_last_error();
        ASSERT_EQ(palpate_run_start(run_), PALPATE_OK) << palpate_last_error();
    }
    palpate_snapshot now() const {
        PALPATE_STRUCT(palpate_snapshot, snapshot);
        palpate_run_snapshot(run_, &snapshot);
        return snapshot;
    }
    bool shows(const std::function<bool(const palpate_snapshot&)>& wanted) const {
        return comes_true([&] { return wanted(now()); });
    }

    Hand hand_;  // outlives the run
    palpate_data* data_ = nullptr;
    palpate_run* run_ = nullptr;
    double stiffness_ = 0;  ///< [N/mm] to ask for; 0: the usual one
};

}  // namespace palpate::c::test
