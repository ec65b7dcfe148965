// Session: layers come and go by command.
#include <gtest/gtest.h>

#include "palpate/baselines/methods.hpp"
#include "palpate/session.hpp"
#include "support/constants.hpp"
#include "support/layer.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;
using enum HapticProperty;

namespace {

std::shared_ptr<Layers> sent_layers(const std::vector<double>& levels, double force = infinity) {
    return std::make_shared<Layers>(surfaces_at(levels, 0.5, force));
}

/// A session on the ramp, whose density is the depth, at level 30.
struct LayeredSession {
    Session session{make_renderer(ramp_field(), 30, at_once()), {.fastest_hand = infinity}};
    double time = 0;

    Tick at(double z) { return advance(session, time += period, ready_at(at_depth(z))).tick; }
    void use(std::shared_ptr<const Layers> layers) {
        apply(session, command::UseLayers{std::move(layers)});
    }
};

}  // namespace

TEST(LayersSession, layers_are_felt_from_the_next_tick_on) {
    LayeredSession live;
    live.at(19);
    EXPECT_EQ(live.at(22).layers.touched, -1);
    live.at(19);
    live.use(sent_layers({20, 40}));
    const Tick tick = live.at(22);
    EXPECT_EQ(tick.layers.touched, 0);
    EXPECT_NEAR(tick.proxy.scp[2], 20, 1e-9);
    EXPECT_NEAR(tick.force[2], -1, 1e-6);
}

TEST(LayersSession, another_scale_does_not_change_the_force_of_a_needle) {
    for (const double scale : {0.3, 3.0}) {
        LayeredSession live;
        const auto layers = sent_layers({20}, 0.5);
        layers->layers[0][drag] = 0.1;
        layers->needle = Needle{};
        live.use(layers);
        for (double z = 15; z < 30; z += 0.01) live.at(z);
        for (int i = 0; i < 10; ++i) live.at(30);
        const Vec3 before = live.at(29.5).force;
        EXPECT_EQ(live.at(29.5).force, before) << "the shaft sticks";
        EXPECT_GT(before.norm(), 0.1);
        apply(live.session, command::Scale{scale});
        for (int i = 0; i < 3; ++i) EXPECT_LT((live.at(29.5).force - before).norm(), 1e-9) << scale;
    }
}

TEST(LayersSession, layers_that_are_none_are_refused_and_change_nothing) {
    LayeredSession live;
    const auto good = sent_layers({20, 40});
    live.use(good);
    live.at(19);
    EXPECT_THROW(live.use(sent_layers({40, 20})), std::invalid_argument);
    EXPECT_THROW(live.use(sent_layers({20, not_a_number})), std::invalid_argument);
    const auto many = sent_layers({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17});
    EXPECT_THROW(live.use(many), std::invalid_argument);
    EXPECT_EQ(live.session.renderer.settings.layers, good);
    EXPECT_EQ(live.at(22).layers.touched, 0);
    live.use(nullptr);
    live.session.renderer.settings.method = &baselines::update_paper;
    EXPECT_THROW(live.use(good), std::invalid_argument) << "a method that knows no layers";
    EXPECT_NO_THROW(live.use(sent_layers({})));
}

TEST(LayersSession, without_layers_the_isovalue_is_felt_again) {
    LayeredSession live;
    live.use(sent_layers({20, 40}, 0.5));
    for (double z = 15; z < 30; z += 0.1) live.at(z);
    EXPECT_EQ(live.at(30).layers.inside, 1);
    live.use(nullptr);
    EXPECT_EQ(live.at(29).layers.inside, 0) << "of none";
    EXPECT_NEAR(live.at(45).proxy.scp[2], 30, 1e-6);
    EXPECT_EQ(live.at(10).proxy.mode, Mode::free) << "nothing holds it from behind";
    apply(live.session, command::Isovalue{25});
    EXPECT_NEAR(live.at(28).proxy.scp[2], 25, 1e-6);
}

TEST(LayersSession, after_all_surfaces_gave_way_the_isovalue_is_felt_without_them) {
    for (const bool null : {true, false}) {
        LayeredSession live;
        live.use(sent_layers({20, 40}, 0.5));
        for (double z = 15; z < 60; z += 0.1) live.at(z);
        EXPECT_EQ(live.at(60).layers.inside, 2);
        live.use(null ? nullptr : sent_layers({}));
        EXPECT_NEAR(live.at(60).proxy.scp[2], 30, 1e-6);
        EXPECT_EQ(live.at(29).proxy.mode, Mode::free);
        EXPECT_NEAR(live.at(32).proxy.scp[2], 30, 1e-6);
    }
}

TEST(LayersSession, an_isovalue_sent_beside_layers_waits_until_they_are_gone) {
    for (const bool ticks_between : {true, false}) {
        LayeredSession live;
        const auto tick = [&](double z) {
            if (ticks_between) live.at(z);
        };
        tick(15);
        live.use(sent_layers({20, 40}));
        tick(15);
        apply(live.session, command::Isovalue{35});
        EXPECT_NEAR(live.at(38).proxy.scp[2], 20, 1e-6) << "of the layers";
        live.use(sent_layers({10, 25}));
        tick(5);
        live.use(nullptr);
        apply(live.session, command::Isovalue{33});
        live.at(5);
        EXPECT_NEAR(live.at(38).proxy.scp[2], 33, 1e-6);
    }
}

TEST(LayersSession, a_state_that_overflowed_keeps_the_isovalue) {
    LayeredSession live;
    live.use(sent_layers({20, 40}));
    live.at(22);
    live.session.renderer.proxy.scp_physical = Vec3::Constant(not_a_number);
    live.at(22);
    live.use(nullptr);
    EXPECT_EQ(live.at(10).proxy.isovalue, 30);
}

TEST(LayersSession, a_clutch_and_a_scale_leave_the_contact_as_it_is) {
    LayeredSession live;
    live.use(sent_layers({20, 40}, 2));
    live.at(19);
    const Tick before = live.at(22);
    apply(live.session, command::Scale{0.5});
    const Tick after = live.at(22);
    EXPECT_NEAR(after.force[2], before.force[2], 1e-9) << "the pull in device mm stays";
    EXPECT_EQ(after.layers.touched, 0);
    apply(live.session, command::Clutch{true});
    live.at(22);
    const Tick held = live.at(60);
    EXPECT_EQ(held.layers.punctured, 0) << "the volume moves with the hand";
    EXPECT_EQ(held.layers.touched, 0);
}
