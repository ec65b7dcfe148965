// Servo: tools that are sent while it runs are felt, and never freed by its ticks; a
// device that renders torque gets one, within its limits.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "palpate/servo.hpp"
#include "support/fields.hpp"
#include "support/press.hpp"
#include "support/scripted_device.hpp"
#include "support/stepped_servo.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// A hand at rest at a depth of 33 in the smooth ramp, whose density is the depth; level 30.
struct ToolServo {
    bool in_tick = false;
    ScriptedDevice device{[](double) { return ready_at(at_depth(33)); }, {.maximum_torque = 2}};
    Servo servo{Session{make_renderer(smooth(ramp_field()), 30, with_torque()), {}}, device,
                stepped()};

    static RendererSettings with_torque() {
        RendererSettings settings;
        settings.device.maximum_torque = 1000;
        return settings;
    }
    bool becomes(const auto& condition) {
        in_tick = true;
        run(servo, 1);
        const bool is_so = ticks_until(servo, condition);
        in_tick = false;
        return is_so;
    }
    /// At rest with the reference point at this depth, held by a tool's contacts or a point's.
    bool is_at(double depth, double tolerance, bool with_tool) {
        return becomes([&] {
            const auto now = servo.snapshot();
            if (!now || with_tool != (now->contact_count > 0)) return false;
            return std::abs(now->session.tick.proxy.scp[2] - depth) < tolerance;
        });
    }
};

}  // namespace

TEST(ToolServo, tools_that_are_sent_are_felt_and_freed_by_others) {
    int freed = 0, freed_by_servo = 0;
    {
        ToolServo live;
        EXPECT_TRUE(live.is_at(30, 1e-6, false));
        for (int i = 0; i < 20; ++i) {
            const double radius = 1 + i % 3;
            const std::shared_ptr<const Tool> tool(new Tool(sphere_tool(radius, 0.3)),
                                                   [&](const Tool* used) {
                                                       ++freed;
                                                       freed_by_servo += live.in_tick;
                                                       delete used;
                                                   });
            ASSERT_TRUE(live.servo.send(command::UseTool{tool}));
            ASSERT_TRUE(live.is_at(30 - radius, 0.1, true)) << radius;
        }
        EXPECT_GE(freed, 10) << "while it runs";
        ASSERT_TRUE(live.servo.send(command::UseTool{nullptr}));
        EXPECT_TRUE(live.is_at(30, 1e-6, false));
        live.servo.stop();
    }
    EXPECT_EQ(freed, 20);
    EXPECT_EQ(freed_by_servo, 0);
}

TEST(ToolServo, torque_reaches_the_device_within_its_limits) {
    ToolServo live;
    // Nearly all energy is in the turn, which gives way more than the other spring: the torque, not
    // the force, meets its limit.
    ForceSettings force;
    force.stiffness = 4;
    force.rotational_stiffness = 4;
    ASSERT_TRUE(live.servo.send(force));
    const auto arm = std::make_shared<const Tool>(std::vector<Vec3>{{3, 3, 0}}, 20.0);
    ASSERT_TRUE(live.servo.send(command::UseTool{arm}));
    EXPECT_TRUE(live.becomes([&] { return live.device.largest_torque() > 1.9; }));
    live.servo.stop();
    EXPECT_LE(live.device.largest_torque(), 2 * (1 + 1e-12));
}

TEST(ToolServo, a_tool_is_refused_where_it_cannot_be_felt) {
    ScriptedDevice device{[](double) { return ready_at(at_depth(33)); }};
    Servo servo{Session{make_renderer(ramp_field(), 30), {}}, device};
    const auto tool = std::make_shared<const Tool>(sphere_tool(1, 0.3));
    EXPECT_THROW(servo.send(command::UseTool{tool}), std::invalid_argument);
    EXPECT_EQ(tool.use_count(), 1) << "it is not held";
}
