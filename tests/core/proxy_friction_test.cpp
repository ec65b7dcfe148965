// Proxy: friction as a cone on its motion, and the paper's method under the same checker.
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/baselines/methods.hpp"
#include "support/fields.hpp"
#include "support/guarantees.hpp"
#include "support/hand.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// Friction breaks G3 and G4 by design.
constexpr Promises only_on_the_free_side{.locally_optimal = false, .never_farther = false};

/// Density z over the whole grid, so that the surface at the isovalue is the plane z = isovalue,
/// solid below it.
Field plane_field(const Geometry& geometry = grid(cube(32))) {
    return linear_field(volume_of<float>(geometry, [](const Index3& i) { return i[2]; }),
                        Solid::below);
}

/// A roof: density 40 - slope |x - 16| - z / 2, ridge along y at x = 16, solid under it.
Field roof_field(double slope) {
    return linear_field(volume_of<float>(grid(cube(32)), [&](const Index3& i) {
        return 40 - slope * std::abs(i[0] - 16) - 0.5 * i[2];
    }));
}

ProxySettings with_friction(double static_coefficient, double dynamic_coefficient) {
    ProxySettings settings;
    settings.friction = {static_coefficient, dynamic_coefficient};
    return settings;
}

Tally run(const TestField& test, ProxyMethod method, const ProxySettings& settings,
          std::uint64_t seed, int updates) {
    Guarantees checked(test.field, method, settings, only_on_the_free_side);
    Hand hand(test.field.geometry(), seed);
    Proxy proxy;
    proxy.isovalue = test.isovalue;
    for (int i = 0; i < updates && !testing::Test::HasFailure(); ++i) {
        SCOPED_TRACE(test.name + " seed " + std::to_string(seed) + " update " + std::to_string(i));
        checked.update(proxy, hand.next());
    }
    checked.print(test.name);
    return checked.tally();
}

std::vector<TestField> unkind_fields() {
    return {noise_field(),
            salt_field(),
            box_field(),
            anisotropic_field(),
            oblique_field(),
            marschner_lobb_field(),
            noise_field(7, Solid::below),
            offset_field(),
            terraces_field()};
}

}  // namespace

TEST(Friction, keeps_the_proxy_on_the_free_side_and_on_the_surface) {
    for (const TestField& test : unkind_fields()) {
        const Tally t = run(test, update_exact, with_friction(0.6, 0.3), 41, scaled(100000));
        EXPECT_GT(t.constrained, t.updates / 20);
        EXPECT_EQ(t.out_of_budget, 0);
        if (HasFailure()) return;
    }
}

TEST(Friction, with_a_dynamic_coefficient_alone_keeps_them_too) {
    for (const TestField& test : {noise_field(), marschner_lobb_field()}) {
        const Tally t = run(test, update_exact, with_friction(0, 0.8), 42, scaled(50000));
        EXPECT_EQ(t.out_of_budget, 0);
        if (HasFailure()) return;
    }
}

TEST(Friction, that_is_below_0_or_no_number_is_refused_and_moves_nothing) {
    const double nan = std::nan("");
    const Field linear = plane_field(), cubic = smooth(linear);
    for (const Field* field : {&linear, &cubic}) {
        Proxy proxy;
        ASSERT_TRUE(place(proxy, *field, Vec3(12, 12, 18), 15.3));
        for (const Friction& friction :
             {Friction{-0.1, 0}, Friction{0.3, -0.1}, Friction{nan, 0}, Friction{0.3, nan}}) {
            for (Friction ProxySettings::*which :
                 {&ProxySettings::friction, &ProxySettings::behind}) {
                ProxySettings settings;
                settings.*which = friction;
                const ProxyUpdate r = update_exact(proxy, *field, Vec3(13, 12, 14), settings);
                EXPECT_EQ(r.status, UpdateStatus::refused);
                EXPECT_EQ(r.scp, Vec3(12, 12, 18));
            }
        }
    }
}

TEST(Friction, holds_the_proxy_below_the_static_angle_and_lets_go_above_it) {
    const Field field = plane_field();
    const ProxySettings settings = with_friction(0.5, 0.25);
    Random random(43);
    for (int i = 0; i < 300; ++i) {
        Proxy proxy;
        const double x = random.uniform(8, 20);
        const double y = random.uniform(8, 20);
        const Vec3 touch(x, y, 15.3);
        ASSERT_TRUE(place(proxy, field, Vec3(x, y, 18), 15.3));
        const Vec3 pressed = touch - Vec3(0, 0, 2);
        update_exact(proxy, field, pressed, settings);
        ASSERT_LE((proxy.scp_physical - touch).norm(), 1e-12);
        Vec3 across(random.uniform(-1, 1), random.uniform(-1, 1), 0);
        across /= across.norm();
        // Held just below the angle, wherever the hand goes.
        update_exact(proxy, field, pressed + 0.999 * across, settings);
        ASSERT_LE((proxy.scp_physical - touch).norm(), 1e-12);
        EXPECT_FALSE(proxy.sliding);
        // Just above it slides, and trails the hand at the dynamic angle: tan = 0.25.
        const Vec3 hip = pressed + 1.001 * across;
        const ProxyUpdate r = update_exact(proxy, field, hip, settings);
        EXPECT_TRUE(proxy.sliding);
        ASSERT_LE((r.scp - (touch + (1.001 - 0.25 * 2) * across)).norm(), 1e-9);
        // While it slides, the dynamic angle holds for any motion of the hand.
        const Vec3 onwards =
            hip +
            Vec3(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.5, 0.5)) +
            across;
        const ProxyUpdate on = update_exact(proxy, field, onwards, settings);
        const Vec3 pull = onwards - on.scp;
        ASSERT_NEAR(std::hypot(pull[0], pull[1]), 0.25 * -pull[2], 1e-9);
    }
}

TEST(Friction, sticks_again_when_the_hand_comes_back_under_the_dynamic_angle) {
    const Field field = plane_field();
    const ProxySettings settings = with_friction(0.5, 0.25);
    Proxy proxy;
    ASSERT_TRUE(place(proxy, field, Vec3(10, 10, 18), 15.5));
    update_exact(proxy, field, Vec3(10, 10, 13.5), settings);
    update_exact(proxy, field, Vec3(12, 10, 13.5), settings);
    ASSERT_NEAR(proxy.scp_physical[0], 11.5, 1e-12);
    update_exact(proxy, field, Vec3(11.6, 10, 13.5), settings);
    EXPECT_FALSE(proxy.sliding);
    EXPECT_NEAR(proxy.scp_physical[0], 11.5, 1e-12);
    update_exact(proxy, field, Vec3(12.4, 10, 13.5), settings);
    EXPECT_NEAR(proxy.scp_physical[0], 11.5, 1e-12) << "the static angle holds again";
}

TEST(Friction, trails_by_the_angle_in_millimetres_on_anisotropic_and_oblique_grids) {
    const Geometry geometry = grid(cube(32), {0.5, 0.7, 2}, {11, -20, 5}, oblique_direction());
    const Field field = plane_field(geometry);
    const ProxySettings settings = with_friction(0.5, 0.25);
    const Vec3 normal = geometry.direction.col(2);
    const Vec3 along = (geometry.direction.col(0) + geometry.direction.col(1)) / std::sqrt(2.0);
    const Vec3 touch = physical_from_index(geometry, {8, 8, 15.3});
    Proxy proxy;
    ASSERT_TRUE(place(proxy, field, touch + normal, 15.3));
    update_exact(proxy, field, touch - normal, settings);
    ASSERT_LE((proxy.scp_physical - touch).norm(), 1e-9);
    update_exact(proxy, field, touch - normal + 3 * along, settings);
    EXPECT_LE((proxy.scp_physical - (touch + 2.75 * along)).norm(), 1e-9);
}

TEST(Friction, holds_on_a_ridge_and_trails_along_it) {
    const Field field = roof_field(0.2);
    const ProxySettings settings = with_friction(0.5, 0.25);
    // The ridge at the isovalue 30 is x = 16, z = 20, its sides fall by 0.4: less than 0.5.
    Proxy proxy;
    ASSERT_TRUE(place(proxy, field, Vec3(16, 10.3, 25), 30));
    ASSERT_EQ(update_exact(proxy, field, Vec3(16, 10.3, 18), settings).mode, Mode::constrained);
    ASSERT_LE((proxy.scp_physical - Vec3(16, 10.3, 20)).norm(), 1e-9);
    update_exact(proxy, field, Vec3(16, 10.6, 18), settings);
    EXPECT_LE((proxy.scp_physical - Vec3(16, 10.3, 20)).norm(), 1e-9);
    Guarantees checked(field, update_exact, settings, only_on_the_free_side);
    const Vec3 hip(16, 13, 18);
    checked.update(proxy, hip);
    EXPECT_TRUE(proxy.sliding);
    EXPECT_GT(proxy.scp_physical[1], 11.5);
    const Vec3 normal = normal_at(proxy, field);
    const double pressed = (proxy.scp_physical - hip).dot(normal);
    const Vec3 along = hip - proxy.scp_physical + pressed * normal;
    // Not exactly: the first move leaves the ridge through a tetrahedron's wall.
    EXPECT_NEAR(along.norm() / pressed, 0.25, 0.02);
}

TEST(Friction, does_not_hold_a_hand_that_leaves_the_surface) {
    for (const TestField& test : {noise_field(), box_field(), marschner_lobb_field()}) {
        Hand hand(test.field.geometry(), 44);
        Proxy proxy;
        proxy.isovalue = test.isovalue;
        int lifted = 0;
        for (int i = 0; i < scaled(20000); ++i) {
            Proxy before = proxy;
            update_exact(proxy, test.field, hand.next(), with_friction(0.6, 0.3));
            // Straight back to where it is: nothing between, so nothing to stick to.
            const ProxyUpdate r =
                update_exact(proxy, test.field, proxy.scp_physical, with_friction(0.6, 0.3));
            ASSERT_LE((r.scp - r.hip).norm(), 1e-9);
            lifted += proxy.mode == Mode::free && before.mode == Mode::constrained;
        }
        EXPECT_GT(lifted, scaled(20000) / 2000);
    }
}

TEST(ProxyPaper, keeps_the_proxy_on_the_free_side_and_on_the_surface) {
    for (const TestField& test : unkind_fields()) {
        const Tally t = run(test, baselines::update_paper, {}, 45, scaled(30000));
        EXPECT_GT(t.constrained, t.updates / 20);
        if (HasFailure()) return;
    }
}

TEST(ProxyPaper, shows_its_steps_goal_by_goal_along_a_plane) {
    // Fig. 5: free to the surface, then a goal before each slide, the last one where the SCP is.
    const Field plane = plane_field();
    Proxy proxy;
    ASSERT_TRUE(place(proxy, plane, Vec3(8, 8, 16), 15.3));
    baselines::update_paper(proxy, plane, Vec3(8.3, 8.1, 15));
    std::vector<Step> steps;
    const StepObserver observer{[](const Step& step, void* context) {
                                    static_cast<std::vector<Step>*>(context)->push_back(step);
                                },
                                &steps};
    const Vec3 scp = baselines::update_paper(proxy, plane, Vec3(14, 11, 12), {}, observer).scp;
    int goals = 0;
    int slides = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        goals += steps[i].kind == StepKind::goal;
        if (steps[i].kind != StepKind::slide) continue;
        ++slides;
        ASSERT_GT(i, 0U);
        EXPECT_EQ(steps[i - 1].kind, StepKind::goal);
        EXPECT_EQ(steps[i - 1].goal, steps[i].goal);
    }
    EXPECT_GT(slides, 3);
    EXPECT_EQ(goals, slides + 1);
    ASSERT_EQ(steps.back().kind, StepKind::goal);
    EXPECT_LE((steps.back().goal - scp).norm(), 1e-8);
}

TEST(ProxyPaper, ends_where_exact_descent_does_on_a_plane_and_sticks_on_a_convex_ridge) {
    const Field plane = plane_field();
    Random random(46);
    for (int i = 0; i < 1000; ++i) {
        Proxy exact;
        ASSERT_TRUE(place(exact, plane, random.point(4, 28).cwiseMax(Vec3(0, 0, 16)), 15.3));
        Proxy paper = exact;
        const Vec3 hip = random.point(4, 28);
        const Vec3 at = update_exact(exact, plane, hip).scp;
        ASSERT_LE((baselines::update_paper(paper, plane, hip).scp - at).norm(), 1e-9);
        const Vec3 expected(hip[0], hip[1], std::max(hip[2], 15.3));
        ASSERT_LE((at - expected).norm(), 1e-9);
    }
    // On a steep ridge nothing satisfies the planes of both sides: the paper's method holds there
    // while the hand goes down inside one of them; exact descent follows it.
    const Field roof = roof_field(1);
    for (int i = 0; i < 100; ++i) {
        Proxy paper;
        const double y = random.uniform(8, 20);
        ASSERT_TRUE(place(paper, roof, Vec3(16, y, 25), 30));
        baselines::update_paper(paper, roof, Vec3(16, y, 19));
        ASSERT_NEAR(paper.scp_physical[2], 20, 1e-9);
        Proxy exact = paper;
        const Vec3 hip(16 + random.uniform(-1, 1), y, 15);
        EXPECT_LE((baselines::update_paper(paper, roof, hip).scp - Vec3(16, y, 20)).norm(), 1e-9);
        EXPECT_LT((update_exact(exact, roof, hip).scp - hip).norm(), 3);
    }
}
