// fidelity in its quick mode, and its parts: true normals, smoothing, nearest points.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "evaluation/claims.hpp"
#include "evaluation/fidelity/nearest_point.hpp"
#include "evaluation/fidelity/trajectory.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/random.hpp"

namespace palpate::evaluation {
namespace {

TEST(Fidelity, claims_hold_in_quick_mode) {
    const Result result = quick_result(fidelity);
    EXPECT_EQ(result.claims.size(), 9U);
    EXPECT_EQ(result.figures.size(), 6U);
    std::size_t measured_elsewhere = 0;
    for (std::size_t i = 0; i < result.table.rows().size(); ++i) {
        if (result.table.text(i, "method") != "incumbent (measured)") continue;
        ++measured_elsewhere;
        EXPECT_EQ(result.table.number(i, "grid"), 128);
        EXPECT_EQ(result.table.number(i, "angle_mean_deg"), 14);
    }
    EXPECT_EQ(measured_elsewhere, 1U);
}

TEST(Fidelity, the_same_table_twice_but_for_the_times) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("torus:40x40x20"));
    const Table first = fidelity(options).table, second = fidelity(options).table;
    ASSERT_EQ(first.rows().size(), second.rows().size());
    for (std::size_t i = 0; i < first.rows().size(); ++i) {
        for (const char* column : {"angle_mean_deg", "turn_max_deg", "jump_max_share"}) {
            EXPECT_EQ(first.number(i, column), second.number(i, column));
        }
    }
}

TEST(Fidelity, volumes_of_the_user_are_gone_round_with_or_without_a_true_surface) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("sphere:40x40x40"));
    options.subjects.push_back(synthetic("shepp-logan:48x48x48"));
    const Result result = fidelity(options);
    EXPECT_TRUE(all_hold(result));
    EXPECT_LT(result.table.number(0, "angle_mean_deg"), 5);
    EXPECT_EQ(result.table.number(0, "contact_share"), 1);
    EXPECT_TRUE(std::isnan(result.table.number(5, "angle_mean_deg")));
    EXPECT_GT(result.table.number(5, "turn_max_deg"), 0);
    EXPECT_EQ(result.figures.size(), 1U);
}

TEST(Fidelity, a_volume_that_cannot_be_gone_round_is_refused) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("sphere:16x16x16", 300));
    EXPECT_THROW(fidelity(options), std::invalid_argument);
    options.subjects = {synthetic("sphere:16x16x16", -1)};  // all of space is solid
    EXPECT_THROW(fidelity(options), std::invalid_argument);
}

TEST(Fidelity, hands_are_as_deep_below_the_true_surface_as_said) {
    for (const Body& body :
         {ball_by_circle(64, Samples::float32), ball_by_spiral(64, Samples::float32),
          torus_by_helix(40, Samples::float32)}) {
        const Subject& subject = body.subject;
        for (int i = 0; i < 200; ++i) {
            const Vec3 hand = body.hand(i / 200.0);
            const Vec3 surface = hand + body.depth * body.ideal(hand);
            EXPECT_NEAR(subject.exact(surface), subject.isovalue, 1e-6) << subject.name;
            EXPECT_GT(subject.exact(hand), subject.isovalue);
            const Vec3 into = true_gradient(subject, surface).normalized();
            EXPECT_LT((-subject.field.sign() * into - body.ideal(hand)).norm(), 1e-6);
        }
        EXPECT_LT(subject.exact(body.start), subject.isovalue);
    }
    const Body ripples = ripples_by_spiral(41, Samples::float32);
    for (int i = 0; i < 200; ++i) {
        EXPECT_GT(ripples.subject.exact(ripples.hand(i / 200.0)), ripples.subject.isovalue);
    }
    EXPECT_LT(ripples.subject.exact(ripples.start), ripples.subject.isovalue);
}

TEST(Fidelity, the_samples_are_those_of_the_exact_density) {
    const Subject ball = protocol_ball(32, Samples::uint8);
    const Geometry& geometry = ball.field.geometry();
    for (const Index3& index : {Index3(3, 4, 5), Index3(16, 2, 9), Index3(0, 0, 0)}) {
        const double exact = ball.exact(physical_from_index(geometry, index.cast<double>()));
        EXPECT_NEAR(ball.field.volume().sample(index), exact, 0.5 + 1e-9);
    }
}

TEST(Fidelity, nearest_points_agree_with_a_fine_search) {
    const Subject noise{"noise",
                        Field(scenes::noise(scenes::centred({6, 6, 6}), SampleType::uint8, 9, 255)),
                        128,
                        {},
                        ""};
    const SurfaceMesh mesh = extract_surface(noise.field, noise.isovalue);
    support::Random random(11);
    for (int i = 0; i < 5; ++i) {
        const Vec3 from(random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, 4));
        double least = std::numeric_limits<double>::infinity();
        constexpr int parts = 12;
        for (const auto& [a, b, c] : mesh.triangles) {
            for (int u = 0; u <= parts; ++u) {
                for (int v = 0; u + v <= parts; ++v) {
                    const Vec3 point = (u * mesh.vertices[a] + v * mesh.vertices[b] +
                                        (parts - u - v) * mesh.vertices[c]) /
                                       parts;
                    least = std::min(least, (point - from).norm());
                }
            }
        }
        const double found = (nearest_point(mesh, from) - from).norm();
        EXPECT_LE(found, least + 1e-12);
        EXPECT_GT(found, least - 0.1);
    }
    EXPECT_THROW(nearest_point(SurfaceMesh{}, Vec3::Zero()), std::invalid_argument);
}

TEST(Fidelity, a_spread_is_of_the_numbers_that_are_there) {
    const Spread spread = spread_of({4, 1, 3, 2});
    EXPECT_EQ(spread.mean, 2.5);
    EXPECT_EQ(spread.max, 4);
    EXPECT_TRUE(std::isnan(spread_of({}).p99));
}

}  // namespace
}  // namespace palpate::evaluation
