// Servo: layers that are sent while it runs are felt, refused if they are none, and never freed by
// its ticks.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "palpate/servo.hpp"
#include "support/press.hpp"
#include "support/scripted_device.hpp"
#include "support/stepped_servo.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

Layers level_that_holds(double level) {
    Layers layers;
    Layer one;
    one.name = "wall";
    one.level = level;
    layers.layers.push_back(one);
    return layers;
}

/// A servo with a hand at rest at a depth of 36 in the ramp, whose density is the depth.
struct LayeredServo {
    bool in_tick = false;
    ScriptedDevice device{[](double) { return ready_at(at_depth(36)); }};
    Queue<SessionEvent> recorder{16};  // soon full: events that are lost must free nothing
    Servo servo{Session{make_renderer(ramp_field(), 30), {}}, device,
                stepped({.recorder = &recorder})};

    bool feels(double level) {
        const auto at_level = [&] {
            const auto now = servo.snapshot();
            return now && std::abs(now->session.tick.proxy.scp[2] - level) < 1e-6;
        };
        in_tick = true;
        run(servo, 1);
        const bool felt = ticks_until(servo, at_level, 1000);
        in_tick = false;
        return felt;
    }
};

}  // namespace

TEST(LayersServo, layers_that_were_sent_are_felt_until_there_are_none) {
    LayeredServo live;
    EXPECT_TRUE(live.feels(30));
    for (const double level : {33.0, 20.0, 35.0}) {
        const auto layers = std::make_shared<const Layers>(level_that_holds(level));
        // The same surface at another level: the hand is not inside of it.
        ASSERT_TRUE(live.servo.send(command::UseLayers{layers, true}));
        EXPECT_TRUE(live.feels(level)) << level;
    }
    ASSERT_TRUE(live.servo.send(command::UseLayers{nullptr}));
    ASSERT_TRUE(live.servo.send(command::Isovalue{25}));
    EXPECT_TRUE(live.feels(25));
    EXPECT_EQ(live.servo.snapshot()->session.tick.layers.touched, -1);
}

TEST(LayersServo, layers_that_are_none_are_refused_before_they_are_sent) {
    LayeredServo live;
    auto layers = std::make_shared<Layers>(level_that_holds(33));
    layers->layers[0].name = "";
    EXPECT_THROW(live.servo.send(command::UseLayers{layers}), std::invalid_argument);
    EXPECT_EQ(live.servo.waiting(), 0);
    EXPECT_EQ(layers.use_count(), 1) << "it is not held";
    EXPECT_TRUE(live.feels(30));
}

TEST(LayersServo, layers_are_freed_by_those_who_send_others) {
    int freed = 0, freed_by_servo = 0;
    {
        LayeredServo live;
        const auto freeing = [&](const Layers* layers) {
            ++freed;
            freed_by_servo += live.in_tick;
            delete layers;
        };
        for (int i = 0; i < 30; ++i) {
            const double level = 31 + i % 4;
            const std::shared_ptr<const Layers> layers(new Layers(level_that_holds(level)),
                                                       freeing);
            ASSERT_TRUE(live.servo.send(command::UseLayers{layers, true}));
            ASSERT_TRUE(live.feels(level));
            // The next ones lie deeper: the hand does not begin inside of them.
            ASSERT_TRUE(i % 4 > 0 || live.servo.send(command::UseLayers{nullptr}));
        }
        EXPECT_GE(freed, 20) << "while it runs";
        live.servo.stop();
        while (live.recorder.pop()) {
        }
    }
    EXPECT_EQ(freed, 30);
    EXPECT_EQ(freed_by_servo, 0);
}
