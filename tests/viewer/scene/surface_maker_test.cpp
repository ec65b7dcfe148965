// Surfaces that are made in the background.
#include <gtest/gtest.h>

#include <cmath>

#include "apps/viewer/scene/surface_maker.hpp"
#include "palpate/edit.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/surface.hpp"
#include "support/fields.hpp"
#include "viewer/waiting.hpp"

namespace palpate::viewer {
namespace {

/// Remembers what the maker has made, one list after the other.
struct Made {
    SurfaceMaker maker;
    std::vector<std::vector<ExtractedSurface>> all;
    int problems = 0;

    explicit Made(const SurfaceLimits& limits = {}) : maker(limits) {
        QObject::connect(&maker, &SurfaceMaker::made, [this] { all.push_back(maker.surfaces()); });
        QObject::connect(&maker, &SurfaceMaker::problem, [this](const QString& what) {
            EXPECT_FALSE(what.isEmpty());
            ++problems;
        });
    }
    const std::vector<ExtractedSurface>& last() {
        wait_until([this] { return !maker.extracting(); });
        return maker.surfaces();
    }
};

Field ball(int edge) {
    return linear_field(scenes::ball(support::cube(edge)));
}

Field noise_of(int edge) {
    return linear_field(
        support::noise_volume<std::uint8_t>(support::grid(support::cube(edge)), 3, 0, 256));
}

std::size_t triangles_at(const Field& field, double level) {
    return extract_surface(field, level).triangles.size();
}

TEST(SurfaceMaker, is_coarse_first_and_then_as_the_proxy_meets_it) {
    Made made;
    const Field field = ball(100);
    made.maker.set_field(field, {128});
    const ExtractedSurface last = made.last().at(0);
    ASSERT_EQ(made.all.size(), 2U);  // every 2nd sample: fewer than 350,000
    for (std::size_t i = 0; i < 2; ++i) {
        ASSERT_EQ(made.all[i].size(), 1U);
        EXPECT_EQ(made.all[i][0].isovalue, 128);
        EXPECT_EQ(made.all[i][0].every, 2 >> i);
        EXPECT_EQ(made.all[i][0].finished, i == 1);
    }
    EXPECT_EQ(triangle_count(last.blocks), triangles_at(field, 128));
    EXPECT_EQ(triangle_count(last.moving), triangle_count(made.all[0][0].blocks));
    EXPECT_LE(triangle_count(last.moving), SurfaceLimits().moving_triangles);
}

TEST(SurfaceMaker, steps_start_small_and_end_with_every_sample) {
    for (const Index3& size :
         {Index3(1, 1, 1), Index3(64, 64, 64), Index3(512, 512, 640), Index3(3000, 20, 1)}) {
        const std::vector<int> steps = steps_for(size);
        EXPECT_EQ(steps.back(), 1);
        EXPECT_LE(size.cast<double>().prod() / std::pow(steps.front(), 3), 350'000);
        for (std::size_t i = 1; i < steps.size(); ++i) EXPECT_EQ(steps[i - 1], 2 * steps[i]);
    }
}

TEST(SurfaceMaker, the_newest_of_fifty_requests_is_the_last_one_made) {
    Made made;
    made.maker.set_field(ball(80), {60});
    for (int i = 1; i <= 50; ++i) made.maker.set_levels({60.0 + 3 * i});
    EXPECT_EQ(made.last().at(0).isovalue, 210);
    EXPECT_TRUE(made.last().at(0).finished);
    // Not all were carried out, and none out of its turn.
    EXPECT_LT(made.all.size(), 50U);
    for (std::size_t i = 1; i < made.all.size(); ++i) {
        EXPECT_LE(made.all[i - 1].at(0).isovalue, made.all[i].at(0).isovalue);
    }
}

TEST(SurfaceMaker, levels_that_stay_keep_their_meshes_wherever_they_stand) {
    Made made;
    const Field field = ball(80);
    made.maker.set_field(field, {60, 128, 200});
    const std::vector<ExtractedSurface> before = made.last();
    ASSERT_EQ(before.size(), 3U);
    for (const ExtractedSurface& one : before) {
        EXPECT_EQ(triangle_count(one.blocks), triangles_at(field, one.isovalue));
    }
    made.maker.set_levels({200, 90, 60});
    const std::vector<ExtractedSurface> after = made.last();
    ASSERT_EQ(after.size(), 3U);
    EXPECT_EQ(after[0], before[2]);
    EXPECT_EQ(after[2], before[0]);
    EXPECT_EQ(triangle_count(after[1].blocks), triangles_at(field, 90));
    made.maker.set_levels({60});
    ASSERT_EQ(made.last().size(), 1U);
    EXPECT_EQ(made.last()[0], before[0]);
}

TEST(SurfaceMaker, keeps_within_its_triangles) {
    SurfaceLimits limits;
    limits.most_triangles = 20'000;
    limits.moving_triangles = 2'000;
    Made made(limits);
    made.maker.set_field(ball(64), {128});
    const ExtractedSurface last = made.last().at(0);
    EXPECT_TRUE(last.finished);
    EXPECT_GT(last.every, 1);
    EXPECT_LE(triangle_count(last.blocks), 20'000U);
    EXPECT_LE(triangle_count(last.moving), 2'000U);
    EXPECT_GT(triangle_count(last.moving), 100U);
}

TEST(SurfaceMaker, what_moves_has_few_triangles_even_of_noise) {
    SurfaceLimits limits;
    limits.moving_triangles = 5'000;
    Made made(limits);
    made.maker.set_field(noise_of(60), {128});
    for (const auto& surfaces : {made.last()}) {
        EXPECT_GT(triangle_count(surfaces.at(0).blocks), 500'000U);
        EXPECT_LE(triangle_count(surfaces.at(0).moving), 5'000U);
    }
    for (const auto& surfaces : made.all) {
        EXPECT_LE(triangle_count(surfaces.at(0).moving), 5'000U) << "at any time";
    }
}

TEST(SurfaceMaker, what_moves_becomes_coarser_on_request) {
    Made made;
    made.maker.set_field(ball(64), {128});
    const ExtractedSurface before = made.last().at(0);
    ASSERT_GT(triangle_count(before.moving), 2'000U);
    made.maker.set_moving_triangles(2'000);
    const ExtractedSurface after = made.last().at(0);
    EXPECT_LE(triangle_count(after.moving), 2'000U);
    EXPECT_GT(triangle_count(after.moving), 100U);
    EXPECT_EQ(after.blocks, before.blocks);
    made.maker.set_levels({120});
    EXPECT_LE(triangle_count(made.last().at(0).moving), 2'000U);
}

TEST(SurfaceMaker, an_edit_makes_only_blocks_that_it_touches_of_both_meshes) {
    SurfaceLimits limits;
    limits.moving_triangles = 30'000;
    Made made(limits);
    Field field = ball(140);
    made.maker.set_field(field, {128});
    const ExtractedSurface before = made.last().at(0);
    ASSERT_NE(before.moving, before.blocks);
    edit::Stroke stroke;
    stroke.brush = brush_for(BrushKind::carve, field, 128, 8);
    stroke.from = stroke.to =
        physical_centre(field.geometry()) + Vec3(0, -0.35 * 140 * field.geometry().spacing[0], 0);
    const Edited after = edited(field.shared_samples(), stroke);
    field.use(after.samples);
    made.maker.update_field(field, after.changed);
    const ExtractedSurface now = made.last().at(0);
    const auto others = [](const MeshBlocks& a, const MeshBlocks& b) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b.at(i);
        return count;
    };
    EXPECT_GT(others(before.blocks, now.blocks), 0U);
    EXPECT_LE(others(before.blocks, now.blocks), 8U);
    EXPECT_GT(others(before.moving, now.moving), 0U);
    Made fresh(limits);
    fresh.maker.set_field(linear_field(flattened(field.samples())), {128});
    EXPECT_EQ(triangle_count(fresh.last().at(0).blocks), triangle_count(now.blocks));
    EXPECT_EQ(triangle_count(fresh.last().at(0).moving), triangle_count(now.moving));
}

TEST(SurfaceMaker, says_what_is_wrong_with_an_isovalue_and_goes_on) {
    Made made;
    made.maker.set_field(ball(16), {std::nan(""), 128});
    EXPECT_TRUE(made.last().at(0).blocks.empty());
    EXPECT_TRUE(made.last().at(1).finished);
    wait_until([&] { return made.problems > 0; });
    made.maker.set_levels({100, 128});
    EXPECT_TRUE(made.last().at(0).finished);
    EXPECT_EQ(made.last().at(0).isovalue, 100);
}

TEST(SurfaceMaker, can_be_destroyed_while_it_extracts) {
    Made made;
    made.maker.set_field(noise_of(160), {128});
    wait_until([&] { return !made.all.empty(); });
    EXPECT_FALSE(made.all.front().at(0).finished);
}

TEST(SurfaceMaker, nothing_comes_of_data_that_were_cleared_or_replaced) {
    Made made;
    made.maker.set_field(noise_of(100), {128});
    made.maker.clear();
    EXPECT_FALSE(made.maker.extracting());
    made.maker.set_field(noise_of(90), {128});
    const Field field = ball(16);
    made.maker.set_field(field, {128});
    EXPECT_TRUE(made.maker.surfaces().empty());
    EXPECT_EQ(triangle_count(made.last().at(0).blocks), triangles_at(field, 128));
    for (const auto& surfaces : made.all) {
        EXPECT_EQ(triangle_count(surfaces.at(0).blocks), triangles_at(field, 128));
    }
}

TEST(SurfaceMaker, another_part_takes_the_place_of_the_last_one_once_it_is_made) {
    Made made;
    const Field field = ball(40);
    const PatchBounds first{field.geometry(), Vec3::Constant(5), Vec3::Constant(9)};
    const PatchBounds second{field.geometry(), Vec3::Constant(7), Vec3::Constant(12)};
    made.maker.set_field(field, {128}, first);
    EXPECT_EQ(made.last().at(0).part, first);
    made.maker.set_field(field, {128}, second);
    ASSERT_EQ(made.maker.surfaces().size(), 1U);
    EXPECT_EQ(made.maker.surfaces()[0].part, first);
    EXPECT_EQ(made.last().at(0).part, second);
}

}  // namespace
}  // namespace palpate::viewer
