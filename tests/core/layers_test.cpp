// Layers: the force of several surfaces in one stroke, against closed forms.
#include "palpate/layers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "support/constants.hpp"
#include "support/fields.hpp"
#include "support/layer.hpp"

using namespace palpate;
using namespace palpate::support;
using enum HapticProperty;

namespace {

/// Five surfaces on the ramp, whose density is the depth in mm.
Layers five_layers() {
    Layers layers;
    layers.layers = {layer_of("skin", 10, 0.4, 1.2), layer_of("fat", 16, 0.2, 0.7),
                     layer_of("fascia", 30, 0.9, 2.0), layer_of("muscle", 33.5, 0.5, 1.0713),
                     layer_of("bone", 60, 1.5, infinity)};
    return layers;
}

/// The force [N] of a straight insertion to a depth [mm]: each surface holds until its force.
double closed_form(const Layers& layers, double depth) {
    double force = 0;
    double reached = 0;  // where the hand was when the last surface gave way
    for (const Layer& l : layers.layers) {
        const double k = *l[stiffness], gives_way = l.level + *l[puncture_force] / k;
        if (std::max(reached, l.level) > depth) break;
        force = depth < gives_way ? k * (depth - l.level) : 0;
        if (depth < gives_way) break;
        reached = gives_way;
    }
    return force;
}

}  // namespace

TEST(Curve, is_linear_between_its_knots_and_constant_beyond) {
    const Curve curve{{{0, 1}, {2, 5}, {3, infinity}}};
    EXPECT_EQ(curve(-7), 1);
    EXPECT_EQ(curve(0.5), 2);
    EXPECT_EQ(curve(2), 5);
    EXPECT_EQ(curve(2.5), infinity);
    EXPECT_EQ(curve(9), infinity);
}

TEST(Layers, say_what_is_wrong_with_them) {
    const auto refused = [](auto&& change, Solid solid = Solid::above) -> std::string {
        Layers layers = five_layers();
        change(layers);
        try {
            check(layers, solid);
        } catch (const std::invalid_argument& e) {
            return e.what();
        }
        return "accepted";
    };
    EXPECT_EQ(refused([](Layers&) {}), "accepted");
    EXPECT_EQ(refused([](Layers&) {}, Solid::below),
              "layer \"fat\": levels must fall from layer to layer, from outside in");
    EXPECT_EQ(refused([](Layers& l) { l.layers[2].name = "skin"; }),
              "layer \"skin\" is there twice");
    EXPECT_EQ(refused([](Layers& l) { l.layers[2].name = ""; }), "layer 3 has no name");
    EXPECT_EQ(refused([](Layers& l) { l.layers[1].level = 10; }),
              "layer \"fat\": levels must rise from layer to layer, from outside in");
    EXPECT_EQ(refused([](Layers& l) { l.layers[1][stiffness] = -1; }),
              "layer \"fat\": stiffness must be at least 0 and finite");
    EXPECT_EQ(refused([](Layers& l) { l.layers[1][puncture_force] = std::nan(""); }),
              "layer \"fat\": puncture force must be at least 0");
    EXPECT_EQ(refused([](Layers& l) {
                  l[drag].density.knots = {{1, 1}, {1, 2}};
              }),
              "the curve over density of drag: its knots must be finite and rise");
    EXPECT_EQ(refused([](Layers& l) { l.layers.resize(17); }), "more than 16 layers");
    EXPECT_EQ(refused([](Layers& l) { l.closing = 0; }),
              "the distance at which surfaces close must be finite and above 0 mm");
    EXPECT_EQ(refused([](Layers& l) { l.needle = Needle{.static_ratio = 0.5}; }),
              "static ratio of the needle = 0.5: must be finite and at least 1");
}

TEST(Layers, give_the_force_of_the_closed_form_at_every_speed) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        Field field = ramp_field();
        field.set_interpolation(interpolation);
        for (const double speed : {5.0, 50.0, 250.0, 1000.0}) {
            const Layers layers = five_layers();
            RenderedHand hand{renderer_of(field, layers)};
            int punctured = 0, ticks = 0;
            double squares = 0;
            for (double depth = 0.30013; depth < 70; depth += speed / 1000) {
                const Tick tick = hand.to(at_depth(depth));
                punctured += tick.layers.punctured;
                const double off = -tick.force[2] - closed_form(layers, depth);
                squares += off * off;
                ++ticks;
                ASSERT_LT(std::abs(off), 1e-6) << speed << " mm/s at " << depth;
                ASSERT_LT(tick.force.head<2>().norm(), 1e-6);
            }
            EXPECT_EQ(punctured, 4);
            EXPECT_LT(std::sqrt(squares / ticks), 0.01);
        }
    }
}

TEST(Layers, are_felt_from_inside_after_they_closed) {
    Layers layers;
    layers.layers = {layer_of("vessel", 20, 0.5, 1), layer_of("core", 40, 0.5, infinity)};
    RenderedHand hand{renderer_of(ramp_field(), layers)};
    double depth = 15;
    for (; depth < 25; depth += 0.1) hand.to(at_depth(depth));
    Tick tick = hand.to(at_depth(25));
    EXPECT_EQ(tick.layers.inside, 1);
    EXPECT_EQ(tick.proxy.mode, Mode::free);
    for (; depth > 18.95; depth -= 0.1) tick = hand.to(at_depth(depth));
    EXPECT_EQ(tick.layers.touched, 0) << "from inside";
    EXPECT_EQ(tick.layers.inside, 1);
    EXPECT_NEAR(tick.proxy.scp[2], 20, 1e-9);
    EXPECT_NEAR(
        tick.force[2],
        0.5 * (20 - hand.renderer.proxy.scp_physical[2] + 20 - 20) + 0.5 * (20 - tick.proxy.hip[2]),
        1e-6);
    for (; depth > 17; depth -= 0.1) tick = hand.to(at_depth(depth));
    EXPECT_EQ(tick.layers.inside, 0) << "it gives way outwards, too";
    EXPECT_EQ(tick.layers.touched, -1);
}

TEST(Layers, stay_open_near_where_they_gave_way) {
    Layers layers;
    layers.layers = {layer_of("skin", 20, 1, 0.5)};
    layers.closing = 2;
    RenderedHand hand{renderer_of(ramp_field(), layers)};
    hand.to(at_depth(19));
    Tick tick = hand.to(at_depth(20.6));
    EXPECT_EQ(tick.layers.punctured, 1);
    EXPECT_EQ(tick.force.norm(), 0);
    tick = hand.to(at_depth(19.5));
    EXPECT_EQ(tick.proxy.mode, Mode::free) << "out again without force";
    EXPECT_EQ(tick.layers.inside, 0);
    tick = hand.to(at_depth(20.3));
    EXPECT_EQ(tick.layers.inside, 1) << "and in again";
    hand.to(at_depth(17.5));
    tick = hand.to(at_depth(20.3));
    EXPECT_EQ(tick.layers.touched, 0) << "it has closed: the SCP was 2.5 mm away";
    EXPECT_EQ(tick.layers.inside, 0);
}

TEST(Layers, take_properties_from_curves_over_density_and_gradient) {
    Layers layers;
    layers.layers = {layer_of("own", 20, 0.3, infinity)};
    layers[stiffness].density.knots = {{0, 0}, {40, 0.8}};
    layers[stiffness].gradient.knots = {{0, 0}, {2, 1}};  // the ramp's is 1
    {
        RenderedHand hand{renderer_of(ramp_field(), layers)};
        hand.to(at_depth(19));
        EXPECT_NEAR(hand.to(at_depth(21)).force[2], -0.3 * 0.5, 1e-9);
    }
    layers.layers[0][stiffness].reset();
    RenderedHand hand{renderer_of(ramp_field(), layers)};
    hand.to(at_depth(19));
    EXPECT_NEAR(hand.to(at_depth(21)).force[2], -0.4 * 0.5, 1e-9);
}

TEST(Layers, without_surfaces_give_the_isovalue_its_properties) {
    Layers layers;
    layers[stiffness].density.knots = {{0, 0}, {40, 0.8}};
    RenderedHand hand{renderer_of(ramp_field(), layers)};
    hand.renderer.proxy.isovalue = 30;
    hand.to(at_depth(29));
    EXPECT_NEAR(hand.to(at_depth(31)).force[2], -0.6, 1e-9);
}

TEST(Layers, slow_a_hand_by_the_viscosity_of_what_it_is_in) {
    Layers layers;
    layers.layers = {layer_of("gel", 20, 0.5, 0.1), layer_of("core", 80, 0.5, infinity)};
    layers.layers[0][viscosity] = 1e-3;
    RenderedHand hand{renderer_of(ramp_field(), layers)};
    Tick tick;
    for (double depth = 10; depth < 19; depth += 0.1) tick = hand.to(at_depth(depth));
    EXPECT_EQ(tick.force.norm(), 0);
    for (double depth = 19; depth < 45; depth += 0.1) tick = hand.to(at_depth(depth));
    EXPECT_NEAR(tick.force[2], -0.1, 1e-3) << "100 mm/s times 1e-3 N s/mm";
}

TEST(Layers, never_render_more_stiffness_than_the_device_takes) {
    Layers layers;
    layers.layers = {layer_of("bone", 20, 50, infinity)};
    Renderer renderer = renderer_of(ramp_field(), layers);
    renderer.settings.device.rate = 1000;
    renderer.settings.device.physical_damping = 1e-3;
    RenderedHand hand{renderer};
    hand.to(at_depth(19));
    EXPECT_NEAR(hand.to(at_depth(20.5)).force[2], -1, 1e-6) << "2 N/mm at most";
}

TEST(Layers, begin_anew_where_the_proxy_is_when_others_take_their_place) {
    RenderedHand hand{renderer_of(ramp_field(), five_layers())};
    for (double depth = 5; depth < 29; depth += 0.1) hand.to(at_depth(depth));
    Layers two;
    two.layers = {layer_of("a", 20, 0.5, infinity), layer_of("b", 40, 0.5, infinity)};
    hand.renderer.settings.layers = std::make_shared<Layers>(two);
    const Tick tick = hand.to(at_depth(29));
    EXPECT_EQ(tick.layers.inside, 1);
    EXPECT_EQ(tick.force.norm(), 0);
}

TEST(Layers, give_way_at_their_force_in_grooves_and_corners_too) {
    // A groove along y at x = 4, whose sides press under 63 degrees; and a corner.
    const auto groove = [](const Index3& i) { return i[2] + 2 * std::abs(i[0] - 4); };
    const auto corner = [](const Index3& i) {
        return i[2] + 2 * std::abs(i[0] - 4) + 3 * std::abs(i[1] - 4);
    };
    Layers layers;
    layers.layers = {layer_of("skin", 30, 0.5, 1)};
    for (const bool is_corner : {false, true}) {
        const Volume volume = is_corner ? volume_of<float>(grid({9, 9, 101}), corner)
                                        : volume_of<float>(grid({9, 9, 101}), groove);
        RenderedHand hand{renderer_of(linear_field(volume), layers)};
        const double gives_way = 30 + 1 / 0.5;
        for (double z = 20; z < gives_way - 0.01; z += 0.05) {
            ASSERT_EQ(hand.to({4, 4, z}).layers.punctured, 0) << z;
        }
        EXPECT_EQ(hand.to({4, 4, gives_way + 0.01}).layers.punctured, 1);
    }
}
