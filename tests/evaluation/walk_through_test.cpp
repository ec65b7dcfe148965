// walk-through in its quick mode, its cuts, and that the figure shows the field exactly.
#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/claims.hpp"
#include "evaluation/walk_through/walk.hpp"
#include "palpate/baselines/methods.hpp"
#include "support/random.hpp"

namespace palpate::evaluation {
namespace {

TEST(WalkThrough, claims_hold_in_quick_mode) {
    const Result result = quick_result(walk_through);
    EXPECT_EQ(result.claims.size(), 5U);
    int goals = 0, slides = 0, free_moves = 0, crossed = 0;
    for (std::size_t i = 0; i < result.table.rows().size(); ++i) {
        if (result.table.text(i, "method") != "paper") continue;
        const std::string& kind = result.table.text(i, "kind");
        goals += kind == "goal";
        slides += kind == "slide";
        free_moves += kind == "free move";
        crossed += kind == "cross";
    }
    // The picture has something of everything.
    EXPECT_GT(goals, 5);
    EXPECT_GT(slides, 5);
    EXPECT_GT(free_moves, 0);
    EXPECT_GT(crossed, 10);
}

TEST(WalkThrough, the_same_table_whatever_the_method_shown_or_the_seed) {
    Options options = quick_options();
    const std::string table = csv_from(walk_through(options).table);
    options.method = "gradient";
    options.seed = 7;
    EXPECT_EQ(csv_from(walk_through(options).table), table);
    EXPECT_NE(walk_through(options).figures[0].caption.find("gradient and by exact"),
              std::string::npos);
}

TEST(WalkThrough, the_steps_are_those_of_the_update_in_order) {
    const Cut cut = wall_cut();
    for (const auto& method : baselines::methods()) {
        const Walk walk = walk_in(cut, method.name);
        ASSERT_FALSE(walk.steps.empty());
        EXPECT_EQ(walk.steps.back().point, walk.end.scp);
        EXPECT_EQ(walk.end.hip, cut.hip);
        if (method.name != std::string("exact")) continue;
        double distance = (walk.before - cut.hip).norm();
        for (const Step& step : walk.steps) {
            const double next = (step.point - cut.hip).norm();
            EXPECT_LE(next, distance + 1e-12);
            distance = next;
        }
    }
}

TEST(WalkThrough, the_density_of_a_cut_does_not_depend_on_z_and_is_linear_in_its_triangles) {
    const Cut cut = slice_of(synthetic("shepp-logan:40x40x40"));
    const Field& field = cut.subject.field;
    support::Random random(5);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 at(random.uniform(0, 39), random.uniform(0, 39), cut.z);
        Vec3 above = at;
        above[2] += random.uniform(-0.99, 0.99);
        EXPECT_NEAR(value_at(field, above), value_at(field, at), 1e-9 * field.range());
        // The triangle of the drawing: centre of the square and two neighbouring corners.
        const Vec3 low(std::floor(at[0]), std::floor(at[1]), cut.z);
        const Vec3 centre = low + Vec3(0.5, 0.5, 0);
        const Vec3 from = at - centre;
        const bool flat = std::abs(from[0]) < std::abs(from[1]);
        const double reach = 2 * std::max(std::abs(from[0]), std::abs(from[1]));
        const Vec3 edge = centre + from / std::max(reach, 1e-9);  // on the square's side
        Vec3 a = edge, b = edge;
        a[flat ? 0 : 1] = low[flat ? 0 : 1];
        b[flat ? 0 : 1] = low[flat ? 0 : 1] + 1;
        const double part = edge[flat ? 0 : 1] - low[flat ? 0 : 1];
        const double side = (1 - part) * value_at(field, a) + part * value_at(field, b);
        const double linear = (1 - reach) * value_at(field, centre) + reach * side;
        EXPECT_NEAR(value_at(field, at), linear, 1e-6 * field.range());
    }
}

TEST(WalkThrough, slices_of_the_user_s_volumes_are_walked_through) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("torus:40x40x20"));
    options.subjects.push_back(synthetic("noise:16x16x16"));
    const Result result = walk_through(options);
    EXPECT_TRUE(all_hold(result));
    EXPECT_EQ(result.claims.size(), 8U);
    ASSERT_EQ(result.figures.size(), 4U);
    EXPECT_EQ(result.figures[0].suffix, "");
    EXPECT_EQ(result.figures[2].suffix, "2");
    const Cut cut = slice_of(options.subjects[0]);
    const Volume& volume = options.subjects[0].field.volume();
    for (int i = 0; i < 40; ++i) {
        EXPECT_EQ(cut.subject.field.volume().sample({i, 7, 1}), volume.sample({i, 7, 10}));
    }
}

TEST(WalkThrough, a_slice_without_a_surface_is_refused) {
    EXPECT_THROW(slice_of(synthetic("sphere:16x16x16", 300)), std::invalid_argument);
    EXPECT_THROW(slice_of(synthetic("sphere:16x16x16", -1)), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::evaluation
