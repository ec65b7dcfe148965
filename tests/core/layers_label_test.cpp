// Layers by place: the surfaces of labels on a grid of their own.
#include <gtest/gtest.h>

#include <cmath>

#include "support/constants.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/layer.hpp"

using namespace palpate;
using namespace palpate::support;
using enum HapticProperty;

namespace {

/// Slabs across z on a grid of 2 mm: label 7 from 20 mm, 3 from 40, 5 from 60. Their surfaces lie
/// half a voxel before their first samples.
Volume slabs() {
    return volume_of<std::int16_t>(grid({12, 12, 60}, Vec3::Constant(2), {-8, -8, 0}),
                                   [](const Index3& i) {
                                       const int z = 2 * i[2];
                                       return z < 20 ? 0 : z < 40 ? 7 : z < 60 ? 3 : 5;
                                   });
}

Layers three_labels() {
    Layers layers;
    layers.by_label = true;
    layers.layers = {layer_of("label 7", 7, 0.4, 0.5), layer_of("label 3", 3, 0.6, 0.9),
                     layer_of("label 5", 5, 0.8, infinity)};
    return layers;
}

Renderer labelled(Field data, Layers layers, const Volume& labels) {
    layers.labels = numbered_labels(labels, layers.layers);
    return make_renderer(std::move(data), 1e3, layered_settings(std::move(layers)));
}

}  // namespace

TEST(LabelLayers, give_the_force_of_the_closed_form_at_every_speed) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        for (const double speed : {20.0, 200.0, 1000.0}) {
            Field data = ramp_field();
            data.set_interpolation(interpolation);
            RenderedHand hand{labelled(data, three_labels(), slabs())};
            int punctured = 0;
            for (double depth = 3.03; depth < 66; depth += speed / 1000) {
                const Tick tick = hand.to(at_depth(depth));
                punctured += tick.layers.punctured;
                double force = 0;
                const std::array<double, 3> at{19, 39, 59};
                for (int i = 0; i < 3; ++i) {
                    const double k = 0.4 + 0.2 * i, most = i == 2 ? infinity : 0.5 + 0.4 * i;
                    if (depth > at[i]) force = k * (depth - at[i]) < most ? k * (depth - at[i]) : 0;
                }
                ASSERT_NEAR(-tick.force[2], force, 1e-6) << speed << " mm/s at " << depth;
            }
            EXPECT_EQ(punctured, 2);
        }
    }
}

TEST(LabelLayers, are_felt_from_inside_and_named) {
    RenderedHand hand{labelled(ramp_field(), three_labels(), slabs())};
    Tick tick;
    for (double depth = 10; depth < 30; depth += 0.1) tick = hand.to(at_depth(depth));
    EXPECT_EQ(tick.layers.inside, 1);
    EXPECT_EQ(tick.layers.touched, -1);
    EXPECT_EQ(tick.force.norm(), 0);
    for (double depth = 30; depth > 18; depth -= 0.1) tick = hand.to(at_depth(depth));
    EXPECT_EQ(tick.layers.touched, 0);
    EXPECT_EQ(tick.layers.inside, 1);
    EXPECT_GT(tick.force[2], 0.3) << "back into the layer";
    for (double depth = 18; depth > 15; depth -= 0.1) tick = hand.to(at_depth(depth));
    EXPECT_EQ(tick.layers.inside, 0);
}

TEST(LabelLayers, tell_the_density_of_the_data_where_they_are_felt) {
    RenderedHand hand{labelled(ramp_field(), three_labels(), slabs())};
    hand.to(at_depth(10));
    const Tick tick = hand.to(at_depth(19.5));
    EXPECT_EQ(hand.renderer.proxy.scp_physical, tick.proxy.scp);
    EXPECT_NEAR(tick.proxy.density, 19, 1e-6) << "the ramp's density is z";
    EXPECT_EQ(tick.proxy.isovalue, 0.5) << "of the labels that may not be entered";
}

TEST(LabelLayers, take_curves_over_the_densities_at_their_surfaces) {
    Layers layers = three_labels();
    layers.layers[0][stiffness].reset();
    layers[stiffness].density.knots = {{0, 0}, {38, 0.76}};
    RenderedHand hand{labelled(ramp_field(), layers, slabs())};
    hand.to(at_depth(18));
    hand.to(at_depth(19.5));
    EXPECT_NEAR(hand.to(at_depth(19.5)).force[2], -0.38 * 0.5, 1e-6) << "the density there is 19";
}

TEST(LabelLayers, are_never_passed_while_they_hold) {
    // Four labels at random in each sample: surfaces everywhere, three and four labels meet.
    Random random(5);
    const Volume labels = volume_of<std::uint8_t>(
        grid(cube(16), Vec3::Constant(1.5), {-1, 0.5, 0.25}, oblique_direction()),
        [&](const Index3&) { return random.below(4); });
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        Layers layers;
        layers.by_label = true;
        layers.layers = {layer_of("0", 1, 0.5, 0.3), layer_of("1", 2, 0.5, 0.3),
                         layer_of("2", 3, 0.5, infinity)};
        Field data = noise_field().field;
        data.set_interpolation(interpolation);
        int touched = 0, punctured = 0, inside = 0;
        const int count = scaled_or_asked(20000);
        // Several hands, as one may be caught in what never gives way.
        for (unsigned seed = 1; seed <= 8; ++seed) {
            RenderedHand hand{labelled(data, layers, labels)};
            Hand moves(labels.geometry(), seed);
            for (int i = 0; i < count / 8; ++i) {
                const std::uint32_t before = hand.renderer.layers.open;
                const Tick tick = hand.to(moves.next());
                ASSERT_TRUE(tick.proxy.scp.allFinite());
                if (tick.proxy.status != UpdateStatus::done) continue;
                touched += tick.layers.touched >= 0;
                punctured += tick.layers.punctured;
                inside += tick.layers.inside > 0;
                if (i == 0 || tick.layers.punctured > 0) continue;
                // At most half of the SCP's place belongs to labels that did not give way.
                const Field& numbers = *hand.renderer.settings.layers->labels;
                const Field closed(volume_of<std::uint8_t>(numbers.geometry(),
                                                           [&](const Index3& at) {
                                                               const int label =
                                                                   int(numbers.volume().sample(at));
                                                               return before >> label & 1U ? 0 : 1;
                                                           }),
                                   Solid::above, before & 1U ? 0 : 1, interpolation);
                ASSERT_LE(value_at(closed, tick.proxy.scp), 0.5 + 1e-9)
                    << "hand " << seed << ", tick " << i;
            }
        }
        EXPECT_GT(touched, count / 4);
        EXPECT_GT(punctured, count / 200);
        EXPECT_GT(inside, count / 10);
    }
}

TEST(LabelLayers, begin_where_the_hand_is_but_in_nothing_that_never_gives_way) {
    Layers layers = three_labels();
    layers.layers[0][puncture_force] = infinity;  // label 7: nobody is in it; behind it one may be
    {
        RenderedHand hand{labelled(ramp_field(), layers, slabs())};
        EXPECT_EQ(hand.to(at_depth(25)).layers.inside, 0);
        EXPECT_NEAR(hand.renderer.proxy.scp_physical[2], 19, 1e-6);
    }
    RenderedHand hand{labelled(ramp_field(), layers, slabs())};
    EXPECT_EQ(hand.to(at_depth(50)).layers.inside, 2);
    EXPECT_EQ(hand.to(at_depth(50)).force.norm(), 0);
}

TEST(LabelLayers, need_a_label_volume_and_good_numbers) {
    Layers layers = three_labels();
    RendererSettings settings;
    settings.layers = std::make_shared<Layers>(layers);
    EXPECT_THROW(make_renderer(ramp_field(), 10, settings), std::invalid_argument);
    layers.layers[1].level = 7;
    EXPECT_THROW(check(layers, Solid::above), std::invalid_argument);
    layers.layers[1].level = 2.5;
    EXPECT_THROW(check(layers, Solid::above), std::invalid_argument);
}
