// Layers while everything round them changes: data, levels, other layers, interpolation, the place
// of the device, and input that is no position.
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/session.hpp"
#include "support/allocation_counter.hpp"
#include "support/constants.hpp"
#include "support/edits.hpp"
#include "support/hand.hpp"
#include "support/layer.hpp"
#include "support/layer_order.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;
using enum HapticProperty;

namespace {

RenderedHand on_ramp(const Layers& layers) {
    return {renderer_of(ramp_field(), layers)};
}

/// Layers of an 8 bit field, at random: more or fewer, holding or giving way, with needles.
std::shared_ptr<const Layers> random_layers(Random& random, double sign) {
    Layers layers;
    const int count = random.below(7);
    double level = random.uniform(20, 120);
    for (int i = 0; i < count; ++i) {
        Layer one;
        one.name = std::to_string(i);
        one.level = sign > 0 ? level : 255 - level;
        level += random.chance(0.2) ? 1e-7 : random.uniform(0, 40);
        one[stiffness] = random.chance(0.1) ? 0 : random.uniform(0, 3);
        one[puncture_force] = random.chance(0.3) ? infinity : random.uniform(0, 1);
        one[static_friction] = random.chance(0.5) ? 0 : random.uniform(0, 1);
        one[viscosity] = random.uniform(0, 1e-3);
        one[drag] = random.uniform(0, 0.1);
        layers.layers.push_back(one);
    }
    if (random.chance(0.5)) layers.needle = Needle{};
    if (random.chance(0.3)) layers[stiffness].gradient.knots = {{0, 0}, {300, 1}};
    layers.closing = random.uniform(0.3, 3);
    return std::make_shared<const Layers>(layers);
}

/// A session with everything that may change, at random.
struct Turmoil {
    Random random;
    Hand hand;
    Session session;
    std::vector<std::shared_ptr<const Samples>> versions;
    std::vector<std::shared_ptr<const Layers>> layers;
    double time = 0;
    Vec3 last_force = Vec3::Zero();
    std::int64_t allocations = 0, frees = 0;
    int recovering = 0, longest_recovery = 0, punctures = 0, touching = 0, needles = 0;

    Turmoil(const Field& field, std::uint64_t seed)
        : random(seed), hand(field.geometry(), seed + 1), session{made(field), {}} {
        for (int i = 0; i < 40; ++i) layers.push_back(random_layers(random, field.sign()));
        auto samples = field.shared_samples();
        for (int i = 0; i < 20; ++i) {
            versions.push_back(samples);
            samples =
                edited(samples, random_edit(random, field.geometry(), SampleType::uint8)).samples;
        }
        const auto frame = [&] { return noise_of(SampleType::uint8, field.geometry(), seed++); };
        versions.push_back(std::make_shared<const Samples>(
            std::vector<Frame>{{0, frame()}, {0.05, frame()}, {0.2, frame()}}, 0.3));
    }
    static Renderer made(const Field& field) {
        RendererSettings settings;
        settings.force.rate_limit = 200;
        settings.force.ramp = 0.01;
        settings.proxy.step_budget = 2000;
        return make_renderer(field, 128, settings);
    }

    /// Counts what the servo thread would allocate and free.
    template <class Work>
    auto counted(Work&& work) {
        const std::int64_t had = thread_allocation_count(), freed = thread_free_count();
        const auto result = work();
        allocations += thread_allocation_count() - had;
        frees += thread_free_count() - freed;
        return result;
    }
    void send(const Command& command) {
        const Renderer& r = session.renderer;
        const CheckedCommand checked(command, r.settings, kind_of(r.field));
        counted([&] {
            apply(session, checked);
            return true;
        });
    }

    void change() {
        const int kind = random.below(9);
        Renderer& renderer = session.renderer;
        if (kind <= 1) send(command::UseLayers{layers[random.bits() % layers.size()]});
        if (kind == 2 && random.chance(0.2)) send(command::UseLayers{nullptr});
        if (kind == 3) send(command::Isovalue{random.uniform(0, 255)});
        if (kind == 4) send(command::Samples{versions[random.bits() % versions.size()]});
        if (kind == 5) {
            send(command::Speed{random.uniform(-2, 2)});
            send(command::Moment{random.uniform(0, 0.3)});
        }
        if (kind == 6) {
            field_will_change(renderer.proxy, renderer.field);
            renderer.field.set_interpolation(random.chance(0.5) ? Interpolation::cubic
                                                                : Interpolation::linear);
        }
        if (kind == 7) send(command::Scale{random.uniform(0.2, 5)});
        if (kind == 8) {
            const Mat3 rotation = random.chance(0.5) ? oblique_direction() : Mat3::Identity();
            send(DeviceTransform{rotation, random.point(-3, 3), random.uniform(0.5, 2)});
        }
    }

    DeviceReading reading() {
        const DeviceTransform& transform = session.renderer.settings.transform;
        DeviceReading made = ready_at(device_from_physical(transform, hand.next()));
        if (random.chance(0.5)) made.orientation = oblique_direction();
        if (random.chance(0.02)) made.position[random.below(3)] = not_a_number;
        if (random.chance(0.02)) made.position *= 1e9;
        if (random.chance(0.02)) made.status = DeviceStatus::stale;
        if (random.chance(0.01)) made.age = not_a_number;
        return made;
    }

    void step() {
        if (random.chance(0.03)) change();
        const double step = random.chance(0.01) ? random.uniform(-0.1, 0.1) : 0.001;
        const DeviceReading read = reading();
        const Tick tick = counted([&] { return advance(session, time += step, read).tick; });
        const UpdateStatus status = tick.proxy.status;
        const Renderer& renderer = session.renderer;
        ASSERT_TRUE(tick.force.allFinite() && tick.proxy.scp.allFinite());
        ASSERT_LE(tick.force.norm(), 3.3 + 1e-12);
        ASSERT_LE(tick.proxy.tetrahedra, 2002);
        ASSERT_LE(tick.layers.punctured, 8);
        ASSERT_NE(status, UpdateStatus::not_finite);
        // A force that stops drops at once.
        if (tick.force_flags == 0 || tick.force_flags == force_rate_limited) {
            ASSERT_LE((tick.force - last_force).norm(), 200 * std::abs(step) + 1e-9);
        }
        last_force = tick.force;
        recovering = status == UpdateStatus::recovering ? recovering + 1 : 0;
        longest_recovery = std::max(longest_recovery, recovering);
        punctures += tick.layers.punctured;
        touching += tick.layers.touched >= 0;
        needles += renderer.layers.needle.inserted;
        if (status == UpdateStatus::done && renderer.settings.layers) expect_in_band(tick);
    }

    void expect_in_band(const Tick& tick) const {
        const Renderer& renderer = session.renderer;
        const auto& all = renderer.settings.layers->layers;
        if (all.empty()) return;
        const Field& field = renderer.field;
        const double density = value_at(field, tick.proxy.scp);
        const auto depth = [&](int l) {
            return field.sign() * (density - all[std::size_t(l)].level) / field.range();
        };
        const LayerState& state = renderer.layers;
        ASSERT_EQ(state.layer_count, int(all.size()));
        ASSERT_TRUE(0 <= state.outer && state.outer <= state.inner);
        ASSERT_LE(state.inner, state.layer_count);
        const double ahead = state.inner < state.layer_count ? depth(state.inner) : -1;
        const double behind = state.outer > 0 ? -depth(state.outer - 1) : -1;
        ASSERT_LE(std::max(ahead, behind), 2e-9);
    }
};

}  // namespace

TEST(LayersChanges, leave_a_contact_alone_where_input_is_no_position) {
    Layers layers = surfaces_at({20, 40}, 0.5, 2);
    layers.layers[1][stiffness] = 1.5;
    RenderedHand one = on_ramp(layers);
    for (double z = 15; z < 30; z += 0.1) one.to(at_depth(z));
    for (double z = 30; z > 17; z -= 0.1) one.to(at_depth(z));
    EXPECT_EQ(one.to(at_depth(17)).layers.touched, 0) << "from inside";
    RenderedHand other = one;
    for (const double broken : {not_a_number, infinity, 1e30}) {
        const Tick tick = other.to({4, 4, broken});
        EXPECT_EQ(tick.proxy.status, UpdateStatus::refused);
        EXPECT_EQ(tick.force, Vec3(0, 0, 0));
        EXPECT_EQ(tick.layers.touched, 0);
        EXPECT_EQ(tick.layers.inside, 1);
        other.time -= 0.001;
    }
    for (double z = 17; z > 10; z -= 0.1) {
        const Tick a = one.to(at_depth(z)), b = other.to(at_depth(z));
        ASSERT_EQ(a.proxy.scp, b.proxy.scp) << z;
        ASSERT_EQ(a.layers.punctured, b.layers.punctured) << z;
        ASSERT_NEAR(a.force[2], b.force[2], 1e-12) << z;
    }
}

TEST(LayersChanges, surfaces_without_stiffness_and_force_are_passed_like_air) {
    Layers layers = surfaces_at({20, 21, 30}, 0.5, 0.4);
    layers.layers[0][stiffness] = layers.layers[0][puncture_force] = 0;
    RenderedHand fast = on_ramp(layers);
    fast.to(at_depth(19));
    const Tick tick = fast.to(at_depth(21.5));
    EXPECT_EQ(tick.layers.punctured, 1);
    EXPECT_NEAR(tick.force[2], -0.25, 1e-9);
    EXPECT_NEAR(tick.proxy.scp[2], 21, 1e-9);
    EXPECT_EQ(fast.to(at_depth(22)).layers.inside, 2);
}

TEST(LayersChanges, a_tick_has_one_budget_however_many_surfaces_give_way) {
    const TestField test = noise_field();
    Layers layers = planned_layers(test, {.parts = {-0.2, -0.1, 0, 0.1, 0.2, 0.3},
                                          .forces = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1},
                                          .stiffnesses = {1, 1, 1, 1, 1, 1}});
    RendererSettings settings;
    settings.layers = std::make_shared<Layers>(layers);
    for (const int budget : {1, 7, 40, 200}) {
        settings.proxy.step_budget = budget;
        Renderer made = make_renderer(test.field, test.isovalue, settings);
        Hand hand(test.field.geometry(), 5);
        int most = 0, exhausted = 0;
        for (int i = 0; i < scaled(5000); ++i) {
            const Tick tick = render(made, {.time = i * 0.001, .position = hand.next()});
            most = std::max(most, tick.proxy.tetrahedra);
            exhausted += tick.proxy.status == UpdateStatus::out_of_budget;
        }
        EXPECT_LE(most, budget + 2);
        EXPECT_GT(exhausted, 0);
    }
}

TEST(LayersChanges, other_layers_without_a_needle_take_it_out) {
    Layers layers = surfaces_at({20, 40}, 0.5, 0.5);
    layers.needle = Needle{};
    RenderedHand one = on_ramp(layers);
    for (double z = 15; z < 30; z += 0.1) one.to(at_depth(z));
    EXPECT_TRUE(one.renderer.layers.needle.inserted);
    one.renderer.settings.layers = std::make_shared<Layers>(surfaces_at({20, 40}, 0.5, 0.5));
    const Tick tick = one.to(at_depth(30) + Vec3(0.5, 0, 0));
    EXPECT_FALSE(one.renderer.layers.needle.inserted);
    EXPECT_EQ(tick.proxy.scp, tick.proxy.hip);
    EXPECT_EQ(tick.force, Vec3(0, 0, 0));
}

TEST(LayersChanges, moved_levels_push_the_proxy_like_an_isovalue) {
    RenderedHand one = on_ramp(surfaces_at({20, 40}, 0.5, 5));
    one.to(at_depth(19));
    for (const double level : {18.0, 10.0, 25.0}) {
        const auto moved = std::make_shared<Layers>(surfaces_at({level, 40}, 0.5, 5));
        ASSERT_TRUE(keep_for(one.renderer.layers, moved));
        one.renderer.settings.layers = moved;
        const Tick tick = one.to(at_depth(19));
        EXPECT_EQ(tick.proxy.status, UpdateStatus::done);
        EXPECT_NEAR(tick.proxy.scp[2], std::min(level, 19.0), 1e-6);
    }
}

TEST(LayersChanges, a_hand_that_starts_inside_is_felt_from_outside) {
    for (const double depth : {25.0, 55.0}) {
        RenderedHand one = on_ramp(surfaces_at({20, 40, 60}, 0.5, infinity));
        Tick tick;
        for (int i = 0; i < 20; ++i) tick = one.to(at_depth(depth));
        EXPECT_EQ(tick.proxy.status, UpdateStatus::done);
        EXPECT_EQ(tick.layers.inside, 0);
        EXPECT_NEAR(tick.proxy.scp[2], 20, 1e-6);
    }
}

TEST(LayersChanges, nothing_gets_stuck_or_out_of_bounds_whatever_changes) {
    for (const Solid solid : {Solid::above, Solid::below}) {
        const TestField test = noise_field(3, solid);
        Turmoil turmoil(test.field, 11);
        const int count = scaled_or_asked(30000);
        for (int i = 0; i < count && !testing::Test::HasFatalFailure(); ++i) {
            SCOPED_TRACE("tick " + std::to_string(i));
            turmoil.step();
        }
        std::printf(
            "[ evidence ] %s: %d ticks, %d punctures, %d touching, %d with a needle, longest "
            "recovery %d ticks\n",
            test.name.c_str(), count, turmoil.punctures, turmoil.touching, turmoil.needles,
            turmoil.longest_recovery);
        EXPECT_LT(turmoil.longest_recovery, 50);
        EXPECT_GT(turmoil.punctures, std::max(0, (count - 10000) / 100));  // short runs meet few
        EXPECT_GT(turmoil.needles, std::max(0, (count - 10000) / 50));
    }
}

TEST(LayersChanges, neither_ticks_nor_other_layers_allocate_or_free) {
    Turmoil turmoil(noise_field().field, 21);
    const int count = scaled(100'000);
    for (int i = 0; i < count && !testing::Test::HasFatalFailure(); ++i) turmoil.step();
    EXPECT_EQ(turmoil.allocations, 0);
    EXPECT_EQ(turmoil.frees, 0);
    EXPECT_GT(turmoil.punctures, count / 100);
}
