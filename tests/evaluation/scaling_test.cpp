// scaling in its quick mode, and the explicit approach that it compares with.
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "evaluation/claims.hpp"
#include "evaluation/scaling/bodies.hpp"
#include "evaluation/scaling/explicit.hpp"
#include "palpate/scenes/volumes.hpp"
#include "scenes/random.hpp"

namespace palpate::evaluation {
namespace {

TEST(Scaling, claims_hold_in_quick_mode) {
    const Result result = quick_result(scaling);
    EXPECT_EQ(result.claims.size(), 7U);  // the last two need the helper program
    EXPECT_EQ(result.figures.size(), 2U);
}

TEST(Scaling, same_seed_gives_the_same_table_but_for_the_times) {
    Options options = quick_options();
    const Table once = scaling(options).table, again = scaling(options).table;
    for (std::size_t i = 0; i < once.rows().size(); ++i) {
        for (const char* column :
             {"tetrahedra", "path_voxel", "constrained_share", "unfinished_changes",
              "worst_deviation_of_range", "explicit_triangles", "hit_difference_voxel"}) {
            const double value = once.number(i, column);
            if (std::isnan(value)) continue;
            EXPECT_EQ(value, again.number(i, column)) << column;
        }
    }
}

TEST(Scaling, a_volume_of_the_user_is_measured_instead_without_the_parts_that_make_bodies) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("torus:40x40x20"));
    std::string notes;
    options.note = [&](const std::string& text) { notes += text; };
    const Result result = scaling(options);
    EXPECT_TRUE(all_hold(result));
    EXPECT_NE(notes.find("left out"), std::string::npos);
    for (std::size_t i = 0; i < result.table.rows().size(); ++i) {
        EXPECT_EQ(result.table.text(i, "volume"), "torus");
        EXPECT_NE(result.table.text(i, "part"), "noise");
    }
}

TEST(Scaling, goes_on_without_the_explicit_approach_where_its_program_cannot_be_run) {
    setenv("PALPATE_EXPLICIT_HELPER", "/nonexistent/palpate-explicit-helper", 1);
    Options options = quick_options();
    options.subjects.push_back(synthetic("sphere:24x24x24"));
    std::string notes;
    options.note = [&](const std::string& text) { notes += text; };
    const Result result = scaling(options);
    unsetenv("PALPATE_EXPLICIT_HELPER");
    EXPECT_TRUE(all_hold(result));
    EXPECT_NE(notes.find("without the explicit approach"), std::string::npos);
    const std::size_t last = result.table.rows().size() - 1;
    EXPECT_TRUE(std::isnan(result.table.number(last, "explicit_triangles")));
    EXPECT_FALSE(std::isnan(result.table.number(last, "change_p50_ns")));
}

TEST(Scaling, stops_while_the_helper_works) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("torus:40x40x20"));
    int calls = 0;
    options.progress = [&](double done) {
        EXPECT_GE(done, 0);
        EXPECT_LE(done, 1);
        // Three speeds, two resolutions, one comparison: after that it waits for the helper.
        if (++calls == 7) throw std::runtime_error("stopped");
    };
    EXPECT_THROW(scaling(options), std::runtime_error);
}

TEST(Bodies, a_ball_has_the_same_samples_round_its_centre_in_a_grid_of_any_size) {
    const Subject small = ball({64, 22, 16}), large = ball({80, 22, 16});
    for (int k = 0; k < 64; k += 3) {
        for (int j = 0; j < 64; j += 3) {
            for (int i = 0; i < 64; ++i) {
                EXPECT_EQ(small.field.volume().sample({i, j, k}),
                          large.field.volume().sample(Index3(i, j, k) + Index3::Constant(8)));
            }
        }
    }
    EXPECT_EQ(large.field.volume().sample({0, 40, 40}), 0);
    EXPECT_EQ(large.field.volume().sample({40, 40, 40}), 255);
    const RayHit hit = cast_ray(small.field, small.isovalue, {40, 0.3, 0.2}, {0, 0.3, 0.2});
    EXPECT_NEAR(hit.point.norm(), 22, 0.05);
}

TEST(Bodies, noise_is_seeded_and_as_large_as_asked_for) {
    const Subject calm = noisy_ball({32, 10, 8}, 0, 1), wild = noisy_ball({32, 10, 8}, 0.4, 1);
    double largest = 0;
    const auto a = calm.field.volume().samples<float>(), b = wild.field.volume().samples<float>();
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, double(std::abs(a[i] - b[i])));
    EXPECT_LE(largest, 0.2 + 1e-6);
    EXPECT_GT(largest, 0.19);
}

TEST(ExplicitApproach, extracts_the_surface_that_is_felt_on_every_type_and_an_oblique_grid) {
    Geometry geometry;
    geometry.size = {30, 34, 26};
    geometry.spacing = {1, 0.8, 1.5};
    geometry.origin = {-7, 30, 12};
    geometry.direction << 0, -1, 0, 0.6, 0, 0.8, -0.8, 0, 0.6;
    for (const SampleType type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        scenes::Scene scene = scenes::make_volume("sphere", geometry, type);
        const Subject subject{"sphere", Field(std::move(scene.volume)), scene.isovalue};
        const auto trajectories = explore(subject, {.trajectories = 2, .trajectory_s = 0.5});
        auto segments = segments_of(subject, trajectories, 100);
        EXPECT_EQ(segments.size(), 100U);
        // A hand that has only just touched may end between the two triangulations.
        std::erase_if(segments, [](const Segment& s) { return (s.to - s.from).norm() < 0.5; });
        EXPECT_GT(segments.size(), 90U);
        const ExplicitAnswer answer = explicit_cost(subject, segments, 1, [] {});
        ASSERT_EQ(answer.failure, "");
        const Difference difference = difference_of(subject, segments, answer.hits);
        EXPECT_EQ(difference.one_sided_share, 0);
        EXPECT_LT(difference.worst_voxel, 0.2);
        EXPECT_GT(answer.cost.tree_bytes, answer.cost.triangles);
        // Euler: a closed surface of genus 0 has 2 V - 4 triangles.
        EXPECT_EQ(answer.cost.triangles, 2 * answer.cost.vertices - 4);
        EXPECT_EQ(answer.cost.mesh_bytes, 12 * (answer.cost.vertices + answer.cost.triangles));
    }
}

}  // namespace
}  // namespace palpate::evaluation
