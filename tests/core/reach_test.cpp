// Reach: a proxy never looks at samples that are not in memory; it waits at their border without a
// force, and goes on when they come, as if they had been there all the time.

#include <gtest/gtest.h>

#include "palpate/lattice.hpp"
#include "palpate/session.hpp"
#include "reach.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/layer.hpp"
#include "support/parameter.hpp"
#include "support/resident.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

Volume rough() {
    return noise_volume<std::uint8_t>(grid({150, 140, 130}, {1, 1, 1.3}), 21, 0, 255);
}
/// Solid where x > 80, free below: a wall across a border of bricks.
Volume wall() {
    const Geometry geometry = grid({160, 100, 100});
    std::vector<float> samples;
    for_each_sample(geometry, [&](const Index3& at) { samples.push_back(float(at[0] - 80)); });
    return {geometry, std::move(samples)};
}

TickInput hand_at(const Vec3& position, int tick) {
    TickInput state;
    state.time = (tick + 1) * period;
    state.position = position;
    return state;
}

struct Judge {
    const Field& whole;
    double isovalue;
    const Field* part = nullptr;
    Vec3 last = Vec3::Zero();
    bool begun = false;
    std::int64_t points = 0;

    /// A step of the path: free by the whole field, and all of it in memory.
    void step(const Step& step) {
        const bool judged = begun && step.kind != StepKind::recover &&
                            step.kind != StepKind::place && step.kind != StepKind::goal;
        if (step.kind == StepKind::goal) return;
        for (int n = 0; judged && n <= 8; ++n) {
            const Vec3 at = last + n / 8.0 * (step.point - last);
            const double excess = whole.sign() * (value_at(whole, at) - isovalue);
            ASSERT_LE(excess / whole.range(), 1e-9);
            ASSERT_TRUE(is_resident(*part, at, 0));
            ++points;
        }
        last = step.point;
        begun = true;
    }
    StepObserver observer() {
        return {[](const Step& step, void* self) { static_cast<Judge*>(self)->step(step); }, this};
    }
};

class ReachOnFields : public testing::TestWithParam<Interpolation> {};

TEST_P(ReachOnFields, with_all_bricks_in_memory_every_tick_has_the_bits_of_the_dense_volume) {
    const Volume volume = rough();
    PartOf part(volume);
    part.add_all();
    RendererSettings settings;
    settings.proxy.friction = {0.4, 0.3};
    Renderer dense = make_renderer(Field(volume, Solid::above, {}, GetParam()), 128, settings);
    Renderer bricks =
        make_renderer(Field(part.samples(), Solid::above, {}, GetParam()), 128, settings);
    Random random(17);
    Vec3 at = Vec3(75, 70, 80);
    for (int tick = 0; tick < scaled(4000) + 100; ++tick) {
        at += random.chance(0.02) ? random.direction() * 40 : random.direction() * 0.7;
        at = at.cwiseMax(Vec3(-5, -5, -5)).cwiseMin(Vec3(155, 145, 175));
        const Tick a = render(dense, hand_at(at, tick)), b = render(bricks, hand_at(at, tick));
        ASSERT_EQ(a.proxy.scp, b.proxy.scp) << tick;
        ASSERT_EQ(a.proxy.status, b.proxy.status);
        ASSERT_EQ(a.force, b.force);
    }
}

TEST_P(ReachOnFields, bricks_that_come_and_go_at_random_never_let_the_proxy_through) {
    const Volume volume = rough();
    const Field whole(volume, Solid::above, {}, GetParam());
    PartOf part(volume);
    Renderer renderer = make_renderer(Field(part.samples(), Solid::above, {}, GetParam()), 128, {});
    Judge judge{whole, 128};
    Random random(18);
    Vec3 at = Vec3(75, 70, 80);
    int waiting = 0, touching = 0;
    for (int tick = 0; tick < scaled(6000) + 200; ++tick) {
        if (random.chance(0.2)) {
            part.change(random, 0.4);
            field_will_change(renderer.proxy, renderer.field);
            renderer.field.use(part.samples());
        }
        at += random.chance(0.03) ? random.direction() * 60 : random.direction() * 0.7;
        at = at.cwiseMax(Vec3(-5, -5, -5)).cwiseMin(Vec3(155, 145, 175));
        judge.part = &renderer.field;
        const Vec3 before = renderer.force.force;
        const Tick now = render(renderer, hand_at(at, tick), judge.observer());
        if (HasFatalFailure()) return;
        ASSERT_EQ(now.proxy.hip, at);
        if (now.proxy.status == UpdateStatus::waiting) {
            ++waiting;
            ASSERT_LE(now.force.norm(), before.norm());
        }
        touching += now.proxy.status == UpdateStatus::done && now.proxy.mode == Mode::constrained;
    }
    EXPECT_GT(waiting, scaled(600));
    EXPECT_GT(touching, is_slow_build ? 0 : scaled(600));
    EXPECT_GT(judge.points, is_slow_build ? 0 : scaled(10000));
}

TEST_P(ReachOnFields, a_free_hand_waits_at_the_border_without_a_force_and_goes_on_when_it_may) {
    const Volume volume = wall();
    PartOf part(volume);
    part.add({0, 0, 0});
    Renderer renderer = make_renderer(Field(part.samples(), Solid::above, {}, GetParam()), 0, {});
    Tick now;
    int tick = 0;
    for (double x = 20; x < 75; x += 0.1) now = render(renderer, hand_at({x, 30, 30}, tick++));
    EXPECT_EQ(now.proxy.status, UpdateStatus::waiting);
    EXPECT_EQ(now.force, Vec3::Zero());
    EXPECT_GT(now.proxy.scp[0], 59);
    EXPECT_LT(now.proxy.scp[0], 64);
    part.add({1, 0, 0});
    renderer.field.use(part.samples());
    now = render(renderer, hand_at({75, 30, 30}, tick++));
    EXPECT_EQ(now.proxy.status, UpdateStatus::done);
    EXPECT_EQ(now.proxy.scp, now.proxy.hip);
}

TEST_P(ReachOnFields, a_proxy_goes_as_near_to_the_border_if_its_hand_is_far_away) {
    const Volume volume = wall();
    PartOf part(volume);
    part.add({0, 0, 0});
    for (const double far : {75.0, 3000.0, 90000.0}) {
        Renderer renderer =
            make_renderer(Field(part.samples(), Solid::above, {}, GetParam()), 0, {});
        Tick now = render(renderer, hand_at({20, 30, 30}, 0));
        for (int tick = 1; tick < 100; ++tick) now = render(renderer, hand_at({far, 30, 30}, tick));
        EXPECT_EQ(now.proxy.status, UpdateStatus::waiting);
        EXPECT_EQ(now.force, Vec3::Zero());
        EXPECT_GT(now.proxy.scp[0], 57) << far;
        EXPECT_LT(now.proxy.scp[0], 64);
    }
}

TEST_P(ReachOnFields, a_hand_deep_in_a_solid_whose_inside_is_missing_rests_where_it_would) {
    const Volume volume = wall();
    PartOf part(volume);
    for (const int y : {0, 1}) {
        for (const int z : {0, 1}) {
            part.add({0, y, z});
            part.add({1, y, z});
        }
    }
    RendererSettings settings;
    settings.force.ramp = 0;
    Renderer dense = make_renderer(Field(volume, Solid::above, {}, GetParam()), 0, settings);
    Renderer bricks =
        make_renderer(Field(part.samples(), Solid::above, {}, GetParam()), 0, settings);
    Tick a, b;
    for (int tick = 0; tick < 200; ++tick) {
        // Its ball reaches far into the brick behind, x from 128 on, which is not there.
        const Vec3 hip(tick < 100 ? 70 + tick * 0.5 : 120, 50 + 0.05 * tick, 50);
        a = render(dense, hand_at(hip, tick));
        b = render(bricks, hand_at(hip, tick));
        ASSERT_NE(b.proxy.status, UpdateStatus::waiting) << tick;
    }
    for (int tick = 200; tick < 1200; ++tick) {
        a = render(dense, hand_at({120, 60, 50}, tick));
        b = render(bricks, hand_at({120, 60, 50}, tick));
    }
    // Either rests where G3 lets it.
    EXPECT_NEAR((a.proxy.scp - b.proxy.scp).norm(), 0, 0.02);
    EXPECT_NEAR((a.force - b.force).norm(), 0, 2e-3);
    EXPECT_GT(b.force.norm(), 1);
}

TEST_P(ReachOnFields,
       a_force_fades_within_its_rate_where_a_brick_goes_and_comes_back_with_the_ramp) {
    const Volume volume = wall();
    PartOf part(volume);
    part.add_all();
    Renderer renderer = make_renderer(Field(part.samples(), Solid::above, {}, GetParam()), 0, {});
    int tick = 0;
    Tick now;
    const auto press = [&](int ticks) {
        for (int n = 0; n < ticks; ++n) {
            const Vec3 before = renderer.force.force;
            now = render(renderer, hand_at({84, 50, 50}, tick++));
            ASSERT_LE((now.force - before).norm(), 2000 * period * 1.0001);
        }
    };
    for (; tick < 640; ++tick) now = render(renderer, hand_at({20 + tick * 0.1, 50, 50}, tick));
    press(500);
    const double full = now.force.norm();
    ASSERT_GT(full, 1);
    part.drop({1, 0, 0});
    renderer.field.use(part.samples());
    press(50);
    EXPECT_EQ(now.proxy.status, UpdateStatus::waiting);
    EXPECT_EQ(now.force, Vec3::Zero());
    EXPECT_EQ(now.proxy.mode, Mode::constrained) << "it holds where it was";
    part.add({1, 0, 0});
    renderer.field.use(part.samples());
    press(50);
    EXPECT_GT(now.force.norm(), 0);
    EXPECT_LT(now.force.norm(), full / 2) << "in the ramp";
    press(400);
    EXPECT_NEAR(now.force.norm(), full, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Fields, ReachOnFields,
                         testing::Values(Interpolation::linear, Interpolation::cubic));

TEST(Reach, a_tool_waits_too_and_none_of_its_points_leaves_what_is_in_memory) {
    const Volume volume = rough();
    const Field whole(volume, Solid::above, {}, Interpolation::cubic);
    PartOf part(volume);
    RendererSettings settings;
    settings.tool = std::make_shared<const Tool>(rod_tool(8, 2));
    Renderer renderer =
        make_renderer(Field(part.samples(), Solid::above, {}, Interpolation::cubic), 128, settings);
    Random random(31);
    Vec3 at(75, 70, 80);
    int waiting = 0, done = 0;
    for (int tick = 0; tick < scaled(3000) + 200; ++tick) {
        if (random.chance(0.2)) {
            part.change(random, 0.3);
            renderer.field.use(part.samples());
        }
        at += random.chance(0.03) ? random.direction() * 60 : random.direction() * 0.5;
        at = at.cwiseMax(Vec3(0, 0, 0)).cwiseMin(Vec3(150, 140, 170));
        TickInput state = hand_at(at, tick);
        state.orientation = random.orientation().toRotationMatrix();
        const Pose before = renderer.tool_proxy->pose;
        const Tick now = render(renderer, state);
        waiting += now.proxy.status == UpdateStatus::waiting;
        if (now.proxy.status == UpdateStatus::waiting && now.proxy.mode == Mode::free) {
            ASSERT_LE(now.force.norm(), 3.3);
        }
        if (now.proxy.status != UpdateStatus::done ||
            before.position == renderer.tool_proxy->pose.position)
            continue;
        ++done;
        for (const Vec3& point : settings.tool->points()) {
            const Pose& pose = renderer.tool_proxy->pose;
            const Vec3 place = pose.position + pose.orientation * point;
            ASSERT_TRUE(is_resident(renderer.field, place, 0)) << tick;
            const double excess = value_at(whole, place) - 128;
            ASSERT_LE(excess / whole.range(), 1e-9) << tick;
        }
    }
    EXPECT_GT(waiting, scaled(300));
    EXPECT_GT(done, scaled(300));
}

enum class Felt { surface, layers, tool };

TEST_P(ReachOnFields, recovery_waits_where_nearer_samples_are_missing) {
    // Free from x = 70 to 80, in brick 1, and from 140 on, in brick 2.
    const Volume volume = volume_of<float>(grid({192, 8, 8}), [](const Index3& i) {
        return (i[0] >= 70 && i[0] <= 80) || i[0] >= 140 ? -1 : 1;
    });
    const Vec3 hand(40, 4, 4);
    for (const Felt felt : {Felt::surface, Felt::layers, Felt::tool}) {
        if (felt == Felt::tool && GetParam() == Interpolation::linear) continue;
        PartOf part(volume);
        part.add({0, 0, 0});
        part.add({2, 0, 0});
        RendererSettings settings;
        if (felt == Felt::layers) {
            Layers layers;
            layers.layers = {layer_of("solid", 0, 0.5, infinity)};
            settings.layers = std::make_shared<const Layers>(layers);
        }
        if (felt == Felt::tool) settings.tool = std::make_shared<const Tool>(sphere_tool(1, 1));
        // The background is solid, so no side is a way out.
        Renderer renderer =
            make_renderer(Field(part.samples(), Solid::above, 1, GetParam()), 0, settings);
        Tick tick;
        for (int i = 0; i < 60; ++i) {
            tick = render(renderer, hand_at(hand, i));
            ASSERT_LT((tick.proxy.scp - hand).norm(), 8) << int(felt) << " tick " << i;
        }
        EXPECT_EQ(tick.proxy.status, UpdateStatus::waiting) << int(felt);
        part.add({1, 0, 0});
        renderer.field.use(part.samples());
        for (int i = 60; i < 160; ++i) tick = render(renderer, hand_at(hand, i));
        EXPECT_EQ(tick.proxy.status, UpdateStatus::done) << int(felt);
        EXPECT_NEAR(tick.proxy.scp[0], 70, 3) << int(felt);
    }
}

TEST(Reach, layers_and_penetrability_wait_until_the_whole_way_of_the_hand_is_there) {
    const Volume volume = wall();
    PartOf part(volume);
    part.add({0, 0, 0});
    RendererSettings settings;
    settings.penetrability = penetrability_threshold(1, 0);
    Renderer renderer =
        make_renderer(Field(part.samples(), Solid::above, {}, Interpolation::cubic), 0, settings);
    int waits = 0;
    for (int tick = 0; tick < 700; ++tick) {
        const Tick now = render(renderer, hand_at({20 + tick * 0.1, 30, 30}, tick));
        ASSERT_TRUE(is_resident(renderer.field, now.proxy.scp, 0));
        waits += now.proxy.status == UpdateStatus::waiting;
    }
    EXPECT_GT(waits, 100);
}

}  // namespace
