// Levels of the density beside labels.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "layers/cover.hpp"
#include "palpate/field.hpp"
#include "support/constants.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/layer.hpp"

using namespace palpate;
using namespace palpate::support;
using enum HapticProperty;

namespace {

/// Levels 30 and 70, and label 7.
Layers skin_bone_and_label() {
    Layers layers;
    layers.by_label = true;
    layers.levels_beside_labels = 2;
    layers.layers = {layer_of("skin", 30, 0.4, 0.5), layer_of("bone", 70, 1, infinity),
                     layer_of("organ", 7, 0.6, 0.8)};
    return layers;
}

/// Label 7 from z = 44 to 55 on the ramp's grid, where `is_there`.
template <class IsThere>
Volume label_slab(IsThere&& is_there) {
    return volume_of<std::uint8_t>(grid({9, 9, 101}), [&](const Index3& i) {
        return is_there(i) && i[2] >= 44 && i[2] < 56 ? 7 : 0;
    });
}
Volume label_slab() {
    return label_slab([](const Index3&) { return true; });
}

RenderedHand mixed(Field data, Layers layers, const Volume& labels) {
    layers.labels = numbered_labels(labels, layers.layers, layers.levels_beside_labels);
    return {make_renderer(std::move(data), 1e3, layered_settings(std::move(layers)))};
}

/// Part of the way at which the density's line from 43 to the solid value of a label crosses the
/// level 70: between the levels 30 and 70, labels are 50 or 90.
constexpr double into_label = 43 + (70.0 - 43) / (90 - 43);

}  // namespace

TEST(MixedLayers, give_the_force_of_the_closed_form_at_every_speed) {
    struct Surface {
        double at, stiffness, most;
    };
    // Out of the label through its own surface, half-way between two samples.
    const Surface surfaces[] = {
        {30, 0.4, 0.5}, {into_label, 0.6, 0.8}, {55.5, 0.6, 0.8}, {70, 1, infinity}};
    for (const double speed : {20.0, 200.0, 1000.0}) {
        RenderedHand hand = mixed(ramp_field(), skin_bone_and_label(), label_slab());
        int punctured = 0;
        for (double depth = 3.03; depth < 75; depth += speed / 1000) {
            const Tick tick = hand.to(at_depth(depth));
            punctured += tick.layers.punctured;
            double force = 0;
            for (const Surface& s : surfaces) {
                const double press = s.stiffness * (depth - s.at);
                if (depth > s.at) force = press < s.most ? press : 0;
            }
            ASSERT_NEAR(-tick.force[2], force, 1e-6) << speed << " mm/s at " << depth;
        }
        EXPECT_EQ(punctured, 3);
    }
}

TEST(MixedLayers, are_named_and_felt_from_inside) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        Field data = ramp_field();
        data.set_interpolation(interpolation);
        RenderedHand hand = mixed(data, skin_bone_and_label(), label_slab());
        const auto move = [&](double from, double to) {
            Tick tick;
            const double step = from < to ? 0.05 : -0.05;
            for (double depth = from; (to - depth) * step > 0; depth += step) {
                tick = hand.to(at_depth(depth));
            }
            return tick;
        };
        Tick tick = move(20, 38);
        EXPECT_EQ(tick.layers.inside, 1) << "in the skin";
        EXPECT_EQ(tick.layers.touched, -1);
        tick = move(38, 44.5);
        EXPECT_EQ(tick.layers.touched, 2) << "on the organ";
        EXPECT_EQ(tick.layers.inside, 1);
        tick = move(44.5, 50);
        EXPECT_EQ(tick.layers.inside, 3) << "in the organ alone";
        EXPECT_EQ(tick.force.norm(), 0);
        tick = move(50, 43);
        EXPECT_EQ(tick.layers.touched, 2);
        EXPECT_EQ(tick.layers.inside, 3);
        EXPECT_GT(tick.force[2], 0.2) << "back into the organ";
        tick = move(43, 36);
        EXPECT_EQ(tick.layers.inside, 1);
        tick = move(36, 29.5);
        EXPECT_EQ(tick.layers.touched, 0) << "on the skin, from inside";
        EXPECT_EQ(tick.layers.inside, 1);
        tick = move(29.5, 20);
        EXPECT_EQ(tick.layers.inside, 0);
    }
}

TEST(MixedLayers, surfaces_of_the_density_are_exact_where_no_label_is_near) {
    const Volume far = label_slab([](const Index3& i) { return i[0] < 2; });
    Layers alone;
    alone.layers = {layer_of("skin", 30, 0.4, 0.5), layer_of("bone", 70, 1, infinity)};
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        Field data = ramp_field();
        data.set_interpolation(interpolation);
        RenderedHand both = mixed(data, skin_bone_and_label(), far);
        RendererSettings settings = both.renderer.settings;
        settings.layers = std::make_shared<Layers>(alone);
        Renderer levels = make_renderer(data, 1e3, settings);
        double time = 0;
        for (double depth = 3; depth < 75; depth += 0.05) {
            const Vec3 at(6.5 + 0.5 * std::sin(depth), 4 + 2 * std::cos(3 * depth), depth);
            time += 0.001;
            const Tick a = both.to(at), b = render(levels, {.time = time, .position = at});
            ASSERT_EQ(a.proxy.scp, b.proxy.scp) << depth;
            ASSERT_EQ(a.layers.touched, b.layers.touched) << depth;
            ASSERT_EQ(a.layers.inside, b.layers.inside) << depth;
        }
    }
}

TEST(MixedLayers, are_never_passed_while_they_hold) {
    // Three labels and much without one at random, on another grid; levels in noise.
    Random random(5);
    const Volume labels = volume_of<std::uint8_t>(
        grid(cube(16), Vec3::Constant(1.5), {-1, 0.5, 0.25}, oblique_direction()),
        [&](const Index3&) { return std::max(0, int(random.below(6)) - 2); });
    for (const Solid solid : {Solid::above, Solid::below}) {
        for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
            const Field noise = noise_field().field;
            Field data(noise.volume(), solid, std::nullopt, interpolation);
            const double low = data.volume().minimum(), range = data.volume().range();
            const auto level = [&](double part) {
                return low + (solid == Solid::above ? part : 1 - part) * range;
            };
            Layers layers;
            layers.by_label = true;
            layers.levels_beside_labels = 2;
            layers.layers = {layer_of("outer", level(0.4), 0.5, 0.3),
                             layer_of("inner", level(0.7), 1, infinity),
                             layer_of("one", 1, 0.5, 0.3), layer_of("two", 2, 0.7, 0.2),
                             layer_of("three", 3, 0.9, infinity)};
            RenderedHand hand = mixed(data, layers, labels);
            Hand moves(data.geometry(), 9);
            int touched = 0, punctured = 0, in_label = 0, on_level = 0;
            const int count = scaled_or_asked(20000);
            for (int i = 0; i < count; ++i) {
                const LayerState before = hand.renderer.layers;
                const Tick tick = hand.to(moves.next());
                ASSERT_TRUE(tick.proxy.scp.allFinite());
                if (tick.proxy.status != UpdateStatus::done) continue;
                touched += tick.layers.touched >= 0;
                on_level += tick.layers.touched >= 0 && tick.layers.touched < 2;
                punctured += tick.layers.punctured;
                in_label += tick.layers.inside > 2;
                ASSERT_LE(tick.layers.inside, 4) << "nobody is in a label that never gives way";
                ASSERT_NE(tick.layers.inside, 2) << "or behind the inner level";
                if (i == 0 || tick.layers.punctured > 0 || !before.covered) continue;
                // The field of both as it was: its level ahead may move with what closes.
                const Field& both = *before.covered;
                const double sign = data.sign(), value = value_at(both, tick.proxy.scp);
                const Proxy& proxy = hand.renderer.proxy;
                const bool same = before.open == hand.renderer.layers.open &&
                                  before.inner == hand.renderer.layers.inner &&
                                  before.outer == hand.renderer.layers.outer;
                if (!same) continue;
                ASSERT_LE(sign * (value - proxy.isovalue), 1e-9 * range) << "tick " << i;
                if (proxy.behind) {
                    ASSERT_GE(sign * (value - *proxy.behind), -1e-9 * range) << "tick " << i;
                }
            }
            EXPECT_GT(touched, count / 4);
            EXPECT_GT(on_level, count / 50);
            EXPECT_GT(punctured, count / 200);
            EXPECT_GT(in_label, count / 100);
        }
    }
}

TEST(MixedLayers, begin_outside_of_a_level_that_the_hand_is_on) {
    RenderedHand hand = mixed(ramp_field(), skin_bone_and_label(), label_slab());
    EXPECT_EQ(hand.to(at_depth(30 + 5e-8)).layers.inside, 0) << "as with levels alone";
}

TEST(MixedLayers, begin_in_the_tissue_round_a_label_that_never_gives_way) {
    Layers layers = skin_bone_and_label();
    layers.layers[2][puncture_force] = infinity;
    RenderedHand hand = mixed(ramp_field(), layers, label_slab());
    EXPECT_EQ(hand.to(at_depth(45)).layers.inside, 1) << "the density there is that of skin";
    for (int i = 0; i < 20; ++i) hand.to(at_depth(45));
    const double z = hand.renderer.proxy.scp_physical[2];
    EXPECT_NEAR(z, into_label, 1e-6) << "recovered out of the label";
}

TEST(MixedLayers, follow_edits_and_leave_labels_where_they_are) {
    RenderedHand hand = mixed(ramp_field(), skin_bone_and_label(), label_slab());
    for (double depth = 20; depth < 36; depth += 0.1) hand.to(at_depth(depth));
    ASSERT_EQ(hand.to(at_depth(36)).layers.inside, 1);
    // Denser by 25 everywhere: bone begins at 45, behind the label's first sample.
    Field denser = linear_field(
        volume_of<float>(grid({9, 9, 101}), [](const Index3& i) { return i[2] + 30.0; }));
    hand.renderer.field.use(denser.shared_samples());
    Tick tick;
    for (double depth = 36; depth < 41; depth += 0.1) tick = hand.to(at_depth(depth));
    EXPECT_EQ(tick.layers.touched, 1) << "bone, now at 40";
    EXPECT_NEAR(tick.proxy.scp[2], 40, 1e-6);
}

TEST(MixedLayers, need_levels_in_order_before_labels) {
    Layers layers = skin_bone_and_label();
    EXPECT_NO_THROW(check(layers, Solid::above));
    EXPECT_THROW(check(layers, Solid::below), std::invalid_argument);
    layers.layers[2].level = 2.5;
    EXPECT_THROW(check(layers, Solid::above), std::invalid_argument);
    layers = skin_bone_and_label();
    layers.levels_beside_labels = 4;
    EXPECT_THROW(check(layers, Solid::above), std::invalid_argument);
}

TEST(FieldCover, is_that_of_a_volume_with_these_samples) {
    Random random(3);
    const Geometry geometry = grid({10, 8, 9}, {1, 0.75, 1.25}, {1, 2, 3}, oblique_direction());
    const Volume data =
        volume_of<float>(geometry, [&](const Index3&) { return double(random.below(200)); });
    for (const bool same_grid : {true, false}) {
        const Geometry other =
            same_grid ? geometry : grid({7, 9, 6}, Vec3::Constant(1.1), {0.03, 3.01, 4.02});
        const auto labels = std::make_shared<const Field>(
            volume_of<std::uint8_t>(other, [&](const Index3&) { return random.below(4); }));
        const auto label_at = [&](const Index3& i) {
            const Vec3 there =
                index_from_physical(other, physical_from_index(geometry, i.cast<double>()));
            const Index3 nearest = (there.array() + 0.5).floor().matrix().cast<int>();
            const bool inside =
                (nearest.array() >= 0).all() && (nearest.array() < other.size.array()).all();
            return inside ? int(labels->volume().sample(nearest)) : 0;
        };
        for (const bool all : {false, true}) {
            // Label 2, and where `all` samples without one.
            const std::uint32_t solid = 4U | (all ? 1U : 0U);
            Field covered = linear_field(data, Solid::above, -5.0);
            LabelCover::put(covered, labels, solid, 40, 160);
            const Field made =
                linear_field(volume_of<float>(geometry,
                                              [&](const Index3& i) {
                                                  const int label = label_at(i);
                                                  if (solid >> label & 1U) return 160.0;
                                                  return label > 0 ? 40.0 : data.sample(i);
                                              }),
                             Solid::above, all ? 160.0 : -5.0);
            for (int z = -2; z < 11; ++z) {
                for (int y = -2; y < 10; ++y) {
                    for (int x = -2; x < 12; ++x) {
                        const Index3 at(x, y, z);
                        ASSERT_EQ(covered.cell(at), made.cell(at)) << at.transpose();
                        ASSERT_EQ(covered.around(at), made.around(at)) << at.transpose();
                    }
                }
            }
        }
    }
}
