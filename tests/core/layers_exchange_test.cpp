// Sets of layers are exchanged while a hand is inside: what is kept, what is forgotten, and that
// nothing of the old set stays behind.
#include <gtest/gtest.h>

#include "palpate/servo.hpp"
#include "palpate/session.hpp"
#include "support/constants.hpp"
#include "support/fields.hpp"
#include "support/layer.hpp"
#include "support/press.hpp"
#include "support/scripted_device.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

using Set = std::shared_ptr<const Layers>;

Set levels(const std::vector<double>& at, double closing = 1) {
    Layers layers = surfaces_at(at, 0.5, 0.5);
    layers.closing = closing;
    return std::make_shared<const Layers>(layers);
}

/// Labels 1 .. `count` in slabs of `thickness` across the ramp, from `begin` on, beside levels.
Set labels(int count, int begin, int thickness, const std::vector<double>& beside = {}) {
    Layers layers = *levels(beside);
    for (int i = 1; i <= count; ++i) {
        layers.layers.push_back(layer_of("label " + std::to_string(i), i, 0.5, 0.5));
    }
    layers.by_label = true;
    layers.levels_beside_labels = beside.size();
    const Volume slabs = volume_of<std::uint8_t>(grid({9, 9, 101}), [&](const Index3& i) {
        const int slab = (i[2] - begin + thickness) / thickness;
        return i[2] >= begin && slab <= count ? slab : 0;
    });
    layers.labels = numbered_labels(slabs, layers.layers, layers.levels_beside_labels);
    return std::make_shared<const Layers>(layers);
}

struct Live {
    Session session;
    double time = 0;

    explicit Live(Interpolation interpolation = Interpolation::linear)
        : session{make_renderer(felt(interpolation), 95, at_once()), {.fastest_hand = infinity}} {}
    static Field felt(Interpolation interpolation) {
        Field field = ramp_field();
        field.set_interpolation(interpolation);
        return field;
    }
    Tick at(double z) { return advance(session, time += period, ready_at(at_depth(z))).tick; }
    Tick go(double from, double to) {
        Tick tick;
        const double step = from < to ? 0.1 : -0.1;
        for (double z = from; (to - z) * step > 0; z += step) tick = at(z);
        return tick;
    }
    void use(const Set& set, bool same_surfaces = false) {
        apply(session, command::UseLayers{set, same_surfaces});
    }
};

}  // namespace

TEST(LayersExchange, a_hand_inside_of_anything_stays_there_and_feels_no_force) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        const std::vector<Set> sets{levels({10, 20, 30}),      labels(3, 10, 20),
                                    levels({20, 40, 60}),      labels(2, 10, 20),
                                    levels({5, 35}),           labels(1, 42, 20, {15, 30}),
                                    levels({20, 40, 80}),      labels(1, 70, 10, {15, 30}),
                                    levels({1, 2, 3, 4, 5, 6})};
        const std::vector<int> inside{3, 2, 2, 2, 2, 3, 2, 2, 6};
        const std::size_t count = sets.size();
        for (std::size_t n = 0; n < count * count * count; ++n) {
            const std::array<std::size_t, 3> way{n % count, n / count % count, n / count / count};
            SCOPED_TRACE(testing::Message() << way[0] << ' ' << way[1] << ' ' << way[2]);
            Live live(interpolation);
            live.use(sets[way[0]]);
            live.go(1, 48);
            for (int i = 0; i < 3; ++i) ASSERT_EQ(live.at(48).force.norm(), 0);
            for (const std::size_t to : {way[1], way[2]}) {
                live.use(sets[to]);
                const Tick tick = live.at(48);
                ASSERT_EQ(tick.proxy.scp, at_depth(48));
                ASSERT_EQ(tick.force.norm(), 0);
                ASSERT_EQ(tick.layers.punctured, 0);
                ASSERT_EQ(tick.layers.inside, inside[to]);
            }
        }
    }
}

TEST(LayersExchange, the_command_says_whether_what_gave_way_stays_open) {
    for (const bool same : {false, true}) {
        Live live;
        live.use(levels({20, 40}, 5));
        live.go(15, 23);
        ASSERT_EQ(live.at(23).layers.inside, 1);
        live.use(levels({20.2, 40}, 5), same);
        const double force = live.go(23, 19.5).force.norm();
        EXPECT_EQ(force == 0, same) << "is the skin still open on the way back?";
    }
    // It cannot be the same surfaces where there are others.
    Live live;
    live.use(levels({10, 20, 30}));
    live.go(1, 48);
    live.use(labels(2, 10, 20), true);
    EXPECT_EQ(live.at(48).force.norm(), 0);
    EXPECT_EQ(live.at(48).layers.inside, 2);
}

TEST(LayersExchange, nothing_of_the_set_before_is_held) {
    for (const bool beside : {false, true}) {
        Live live;
        Set set = labels(2, 10, 20, beside ? std::vector<double>{5} : std::vector<double>{});
        live.use(set);
        live.go(1, 30);
        const std::weak_ptr<const Samples> samples = set->labels->shared_samples();
        const std::weak_ptr<const Samples> data = live.session.renderer.field.shared_samples();
        DeviceReading stale = ready_at(at_depth(30));
        stale.status = DeviceStatus::stale;
        advance(live.session, live.time += period, stale);
        live.use(levels({20, 40}));
        apply(live.session, command::Samples{ramp_field().shared_samples()});
        EXPECT_FALSE(samples.expired());
        set.reset();  // as the servo's owner does, away from its thread
        EXPECT_TRUE(samples.expired());
        EXPECT_TRUE(data.expired());
    }
}

TEST(LayersExchange, a_set_is_not_taken_for_the_one_whose_memory_it_got) {
    Live live;
    std::shared_ptr<const Layers>& set = live.session.renderer.settings.layers;
    set = levels({10, 20, 30});
    EXPECT_EQ(live.go(1, 25).layers.inside, 2);
    const Layers next = *levels({26, 27, 40});
    set.reset();
    set = std::make_shared<const Layers>(next);
    const Tick tick = live.at(25);
    EXPECT_EQ(tick.layers.inside, 0);
    EXPECT_EQ(tick.layers.punctured, 0);
    EXPECT_EQ(tick.proxy.scp, tick.proxy.hip);
}

TEST(LayersExchange, new_samples_replace_those_under_the_labels_at_once) {
    Live live;
    live.use(labels(1, 40, 20, {20}));
    live.go(1, 30);
    const std::weak_ptr<const Samples> before = live.session.renderer.field.shared_samples();
    apply(live.session, command::Samples{ramp_field().shared_samples()});
    EXPECT_TRUE(before.expired()) << "though there was no tick";
}

TEST(LayersExchange, a_needle_is_out_after_another_tool) {
    Live live(Interpolation::cubic);
    Layers needle = *levels({20, 40});
    needle.needle = Needle{};
    live.use(std::make_shared<const Layers>(needle));
    live.go(15, 30);
    ASSERT_TRUE(live.session.renderer.layers.needle.inserted);
    // As the servo applies it: layers rest beside a tool.
    make_room_for_tools(live.session.renderer);
    const auto take = [&](std::shared_ptr<const Tool> tool) {
        const Renderer& renderer = live.session.renderer;
        RendererSettings without = renderer.settings;
        without.layers.reset();
        apply(live.session,
              CheckedCommand(command::UseTool{std::move(tool)}, without, kind_of(renderer.field)));
        live.at(10);
    };
    take(std::make_shared<const Tool>(sphere_tool(1, 0.5)));
    take(nullptr);
    EXPECT_FALSE(live.session.renderer.layers.needle.inserted);
}

TEST(LayersFelt, magnet_and_normal_are_those_of_the_surface_that_holds_the_proxy) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        Live live(interpolation);
        live.use(labels(1, 40, 20));
        ForceSettings force = live.session.renderer.settings.force;
        force.magnet = {1, 0.5};
        apply(live.session, force);
        live.go(30, 39.2);
        EXPECT_GT(live.at(39.2).force[2], 0.05) << "drawn to the label, which begins at 39.5";
        EXPECT_EQ(live.at(38).force.norm(), 0);
        live.go(38, 40);
        SessionTick tick = advance(live.session, live.time += period, ready_at(at_depth(40)));
        ASSERT_EQ(tick.tick.layers.touched, 0);
        Snapshot seen = snapshot_of(live.session, tick, 0, 0);
        EXPECT_LT((seen.normal - Vec3(0, 0, -1)).norm(), 1e-9);
        EXPECT_NEAR(tick.tick.proxy.density, 39.5, 1e-6) << "of the data";
        const Vec3 at = index_of(seen.interpolation, seen.scp);
        EXPECT_LT((at - tick.tick.proxy.scp).norm(), 1e-9) << "on the lattice of the data";
    }
}

TEST(LayersFelt, a_field_that_changes_under_labels_leaves_no_normal_behind) {
    Live live;
    live.use(labels(1, 40, 20));
    live.go(30, 40);
    ASSERT_EQ(live.at(40).layers.touched, 0);
    apply(live.session, command::Samples{ramp_field().shared_samples()});
    live.at(40);
    EXPECT_TRUE(live.session.renderer.proxy.normal_before.isZero(0)) << "labels stand still";
    live.use(labels(1, 40, 20, {20}));
    live.at(39);
    live.go(39, 40);
    ASSERT_EQ(live.at(40).layers.touched, 1);
    apply(live.session, command::Samples{ramp_field().shared_samples()});
    EXPECT_LT((live.session.renderer.proxy.normal_before - Vec3(0, 0, -1)).norm(), 1e-9);
    live.at(40);
    EXPECT_TRUE(live.session.renderer.proxy.normal_before.isZero(0));
}
