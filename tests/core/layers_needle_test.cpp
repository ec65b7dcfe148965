// A needle in layers: insertion, drag, withdrawal, bodies in a row, and surfaces that hold.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "palpate/renderer.hpp"
#include "support/constants.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/layer.hpp"

using namespace palpate;
using namespace palpate::support;
using enum HapticProperty;

namespace {

Layer needled(const std::string& name, double level, double k, double force, double drag_force) {
    Layer made = layer_of(name, level, k, force);
    made[drag] = drag_force;
    return made;
}

/// A skin at 0 that gives way at 0.5 N, 1 mm deep, and what is behind it.
Layers one_skin(double drag_force = 0.02) {
    Layers layers;
    layers.layers = {needled("skin", 0, 0.5, 0.5, drag_force)};
    layers.needle = Needle{};
    return layers;
}

/// Density by depth, along z.
Field field_along(double depth, Interpolation interpolation,
                  const std::function<double(double)>& density) {
    return Field(volume_of<float>(grid({7, 7, int(depth) + 1}),
                                  [&](const Index3& i) { return density(i[2]); }),
                 Solid::above, std::nullopt, interpolation);
}
/// A body from 20 to 40 mm.
double slab(double z) {
    return 10 - std::abs(z - 30);
}

/// One body from 20 to 40 mm and another from there on, apart by the gap, in samples of 0.2 mm.
Field bodies_apart(double gap) {
    const auto density = [gap](const Index3& i) {
        const double z = 0.2 * i[2];
        return std::min(z - 20, std::abs(z - 40 - 0.5 * gap) - 0.5 * gap);
    };
    return linear_field(volume_of<float>(grid({7, 7, 400}, Vec3::Constant(0.2)), density),
                        Solid::above, -20);
}

struct NeedleHand {
    Renderer renderer;
    double time = 0, depth = 0;
    int punctured = 0;
    Tick last{};
    double farthest_off_line = 0;

    NeedleHand(const Field& field, const Layers& layers, double at)
        : renderer(renderer_of(field, layers)) {
        to(at);
    }
    const NeedleState& needle() const { return renderer.layers.needle; }
    double tip() const { return last.proxy.scp[2]; }
    double force() const { return last.force[2]; }

    const Tick& to(const Vec3& position, const Vec3& pointing = Vec3::Zero()) {
        last =
            render(renderer, {.time = time += 0.001, .position = position, .pointing = pointing});
        punctured += last.layers.punctured;
        depth = position[2];
        if (needle().inserted) {
            const Vec3 from_entry = last.proxy.scp - needle().entry;
            const Vec3 aside = from_entry - needle().axis * needle().axis.dot(from_entry);
            farthest_off_line = std::max(farthest_off_line, aside.norm());
        }
        return last;
    }
    const Tick& to(double z) { return to(Vec3(3.2, 2.9, z)); }
    /// At this speed [mm/s] to a depth.
    void move(
        double z, double speed, const std::function<void()>& each = [] {}) {
        const double step = speed / 1000;
        while (std::abs(z - depth) > step) {
            to(depth + std::copysign(step, z - depth));
            each();
            if (testing::Test::HasFatalFailure()) return;
        }
        to(z);
    }
};

constexpr Interpolation both[] = {Interpolation::linear, Interpolation::cubic};

}  // namespace

TEST(Needle, has_the_drag_of_the_closed_form_in_and_out_at_every_speed) {
    for (const Interpolation interpolation : both) {
        const Field field = field_along(100, interpolation, [](double z) { return z - 20; });
        for (const double speed : {5.0, 50.0, 250.0, 1000.0}) {
            Layers layers = one_skin(0.02);
            layers.layers.push_back(needled("muscle", 10, 0.5, 0.25, 0.05));
            NeedleHand hand(field, layers, 15);
            const auto drag_at = [](double z) {
                return 0.02 * std::max(0.0, std::min(z, 30.0) - 20) + 0.05 * std::max(0.0, z - 30);
            };
            hand.move(50, speed, [&] {
                const double z = hand.depth;
                // The skin holds to 21; the muscle, from 30 on, to 30.5. Then friction builds up.
                if (z < 20 || (z > 21.1 + speed / 500 && z < 30) || z > 33) {
                    ASSERT_NEAR(hand.force(), -drag_at(z), 2e-8) << z << " at " << speed;
                } else if (z > 30.01 && z < 30.49) {
                    ASSERT_NEAR(hand.force(), -0.5 * (z - 30) - drag_at(30), 2e-8) << z;
                }
            });
            EXPECT_EQ(hand.punctured, 2);
            EXPECT_EQ(hand.needle().crossing_count, 2);
            // Back: first the shaft sticks, over twice the drag.
            hand.move(10, speed, [&] {
                const double z = hand.depth;
                if (z < 44 && z > 19 + speed / 1000) {
                    ASSERT_NEAR(hand.force(), drag_at(z), 2e-8) << z << " at " << speed;
                } else if (z < 19) {
                    ASSERT_EQ(hand.force(), 0) << z;
                }
            });
            EXPECT_EQ(hand.punctured, 2) << "its own channel takes no force";
            EXPECT_FALSE(hand.needle().inserted);
            EXPECT_EQ(hand.last.layers.inside, 0);
            EXPECT_LT(hand.farthest_off_line, 1e-9);
        }
    }
}

TEST(Needle, sticks_at_rest_and_slides_again_above_its_static_friction) {
    const Field field = field_along(100, Interpolation::linear, [](double z) { return z - 20; });
    Layers layers = one_skin(0.02);
    layers.needle->static_ratio = 1.5;
    NeedleHand hand(field, layers, 15);
    hand.move(40, 50);
    const double sliding = 0.02 * 20;
    for (int i = 0; i < 5; ++i) hand.to(40);
    double most = 0;
    for (int i = 0; i < 5000; ++i) {
        hand.to(hand.depth - 0.0005);  // 0.5 mm/s: slower than it sticks below
        most = std::max(most, hand.force());
    }
    EXPECT_LT(most, 1.5 * sliding);
    EXPECT_GT(most, 1.5 * sliding * 0.9) << "a tenth of the shaft is out";
    hand.move(30, 50);
    EXPECT_NEAR(hand.force(), 0.02 * 10, 1e-6);
}

TEST(Needle, goes_out_of_the_far_side_of_a_body_and_all_the_way_back) {
    for (const Interpolation interpolation : both) {
        const Field field = field_along(60, interpolation, slab);
        for (const double speed : {5.0, 100.0, 1000.0}) {
            NeedleHand hand(field, one_skin(0.02), 15);
            hand.move(39, speed);
            EXPECT_EQ(hand.punctured, 1);
            EXPECT_EQ(hand.last.layers.inside, 1);
            hand.move(50, speed);
            EXPECT_EQ(hand.punctured, 2) << "in and out";
            EXPECT_EQ(hand.last.layers.inside, 0);
            EXPECT_EQ(hand.needle().crossing_count, 2);
            EXPECT_NEAR(hand.force(), -0.02 * 20, 1e-6) << "the shaft is inside for 20 mm";
            hand.move(30, speed);
            EXPECT_EQ(hand.last.layers.inside, 1);
            EXPECT_NEAR(hand.force(), 0.02 * 10, 1e-6);
            hand.move(45, speed);  // the far side has closed
            EXPECT_EQ(hand.punctured, 3);
            EXPECT_NEAR(hand.force(), -0.02 * 20, 1e-6);
            hand.move(10, speed);
            EXPECT_EQ(hand.punctured, 3);
            EXPECT_FALSE(hand.needle().inserted);
            EXPECT_EQ(hand.last.force, Vec3(0, 0, 0));
        }
    }
}

TEST(Needle, rubs_in_two_bodies_in_a_row_however_near_they_are) {
    for (const double gap : {6.0, 0.6}) {
        const Field field = bodies_apart(gap);
        for (const double speed : {5.0, 1000.0}) {
            Layers layers = one_skin(0.02);
            layers.layers[0][puncture_force] = 0.05;
            NeedleHand hand(field, layers, 15);
            hand.renderer.settings.transform.translation = Vec3(-2.6, -2.3, 0);
            hand.move(70, speed);
            const double inside = 20 + 30 - gap;
            EXPECT_NEAR(hand.force(), -0.02 * inside, 0.02 * 2.5) << gap << " at " << speed;
            EXPECT_EQ(hand.last.layers.inside, 1);
            hand.move(10, speed);
            EXPECT_FALSE(hand.needle().inserted);
            EXPECT_EQ(hand.last.force, Vec3(0, 0, 0));
        }
    }
}

TEST(Needle, rubs_no_more_once_its_tip_is_out_of_a_thin_sheet) {
    for (const Interpolation interpolation : both) {
        const Field field = field_along(60, interpolation, slab);
        Layers layers = one_skin(0.1);
        layers.layers[0].level = 9.6;  // at most 0.8 mm wide
        layers.layers[0][puncture_force] = 0.1;
        for (const double speed : {5.0, 500.0}) {
            NeedleHand hand(field, layers, 15);
            hand.move(36, speed);
            const double then = hand.force();
            EXPECT_GE(then, -0.1 * (0.8 + 1 + speed / 1000));
            hand.move(50, speed);
            EXPECT_NEAR(hand.force(), then, 1e-9) << "only the sheet rubs";
            hand.move(10, speed);
            EXPECT_FALSE(hand.needle().inserted);
        }
    }
}

TEST(Needle, holds_at_the_surface_that_finds_no_more_room_for_crossings) {
    // Bodies of 2 mm every 4 mm: 64 crossings are 32 bodies.
    const Field field = field_along(200, Interpolation::linear,
                                    [](double z) { return 1 - std::abs(std::fmod(z, 4) - 2); });
    Layers layers = one_skin(0);
    layers.layers[0][puncture_force] = 0.1;
    layers.closing = 0.4;
    NeedleHand hand(field, layers, 0.2);
    hand.move(180, 100);
    EXPECT_EQ(hand.needle().crossing_count, NeedleState::most_crossings);
    EXPECT_EQ(hand.punctured, 64);
    EXPECT_NEAR(hand.tip(), 4 * 32 + 1, 1e-9);
    EXPECT_NEAR(hand.force(), -0.5 * (180 - hand.tip()), 1e-6);
    hand.move(0.2, 100);
    EXPECT_FALSE(hand.needle().inserted);
}

TEST(Needle, goes_where_the_tool_points_and_is_pushed_back_to_its_line) {
    for (const Interpolation interpolation : both) {
        const Field field =
            Field(volume_of<float>(grid({60, 40, 80}), [](const Index3& i) { return i[2] - 20; }),
                  Solid::above, std::nullopt, interpolation);
        const Vec3 pointing = Vec3(0.6, 0, 0.8);
        NeedleHand hand(field, one_skin(0), 15);
        const Vec3 start(10, 20, 15);
        for (double s = 0; s < 30; s += 0.05) hand.to(start + s * pointing, pointing);
        EXPECT_EQ(hand.needle().axis, pointing);
        EXPECT_LT(hand.farthest_off_line, 1e-9);
        const Vec3 at = start + 30 * pointing;
        for (double s = 0; s <= 2; s += 0.05) {
            const Vec3 position = at + s * Vec3::UnitY();
            hand.to(position, pointing);
            const Vec3 from_entry = position - hand.needle().entry;
            const Vec3 aside = from_entry - pointing * pointing.dot(from_entry);
            ASSERT_LT((hand.last.force + 0.3 * aside).norm(), 1e-9);
        }
        EXPECT_LT((hand.last.proxy.scp - at).norm(), 1);
    }
}

TEST(Needle, never_goes_through_a_surface_that_holds_and_stays_on_its_line) {
    for (const TestField& test : {noise_field(), oblique_field(), anisotropic_field()}) {
        for (const Interpolation interpolation : both) {
            Field field = test.field;
            field.set_interpolation(interpolation);
            const double range = field.range();
            Layers layers;
            layers.layers = {needled("skin", test.isovalue - 0.2 * range, 0.5, 0.3, 0.02),
                             needled("fat", test.isovalue, 0.3, 0.2, 0.05),
                             needled("bone", test.isovalue + 0.25 * range, 1, infinity, 0)};
            layers.needle = Needle{};
            NeedleHand hand(field, layers, -2);
            Hand way(field.geometry(), 17, {.slide = 2, .sweep = 4, .jump = 1});
            Random random(18);
            Vec3 pointing = random.direction();
            double deepest = -1;
            int inserted = 0;
            for (int i = 0; i < scaled(10000); ++i) {
                if (i % 200 == 0) pointing = random.direction();
                hand.farthest_off_line = 0;
                hand.to(way.next(), pointing);
                inserted += hand.needle().inserted;
                ASSERT_LT(hand.farthest_off_line, 1e-8) << i;
                ASSERT_TRUE(hand.last.force.allFinite());
                ASSERT_EQ(hand.last.proxy.status, UpdateStatus::done);
                const double density = value_at(field, hand.last.proxy.scp);
                deepest = std::max(deepest, (density - layers.layers[2].level) / range);
            }
            EXPECT_LE(deepest, 1e-9);
            EXPECT_GE(inserted, scaled(10000) / 100);
            EXPECT_GE(hand.punctured, scaled(10000) / 2000);
        }
    }
}
