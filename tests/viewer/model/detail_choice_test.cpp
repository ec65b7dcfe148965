// Levels and boxes for pictures: about a sample a pixel, within limits, never finer than what is
// felt; and samples that join the overview's.
#include "apps/viewer/model/detail.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/field.hpp"
#include "support/edits.hpp"
#include "support/random.hpp"

namespace palpate::viewer {
namespace {

using support::Random;

/// Levels of 2048 samples along each axis and coarser ones, each shifted as means of two are.
stream::StoreInfo pyramid(const Index3& chunk = Index3::Constant(64)) {
    stream::StoreInfo info;
    for (int level = 0; level < 6; ++level) {
        const double step = std::ldexp(1.0, level);
        Geometry grid{Index3::Constant(2048 >> level), Vec3::Constant(step),
                      Vec3::Constant(10 + 0.5 * (step - 1)), Mat3::Identity()};
        info.levels.push_back({grid, chunk});
    }
    return info;
}

SeenStore seen_store(const stream::StoreInfo& info, int finest = 0) {
    return {&info, finest, info.levels[4].geometry};
}

constexpr DetailLimits no_limits{std::int64_t{1} << 60, std::uint64_t{1} << 60,
                                 std::int64_t{1} << 60};

SeenBox random_box(Random& random) {
    SeenBox seen;
    for (int a = 0; a < 3; ++a) {
        seen.from[a] = random.uniform(0, 2060);
        seen.to[a] = random.uniform(0, 2060);
    }
    seen.pixel_mm = std::exp2(random.uniform(-2, 6));
    return seen;
}

TEST(DetailChoice, a_sample_is_about_a_pixel) {
    const stream::StoreInfo info = pyramid();
    const SeenStore store = seen_store(info);
    const SeenBox seen{Vec3::Constant(100), Vec3::Constant(120), 1};
    const auto level = [&](double pixel) {
        SeenBox at = seen;
        at.pixel_mm = pixel;
        return level_for(store, at, no_limits);
    };
    EXPECT_EQ(level(0.1), 0);
    EXPECT_EQ(level(1), 0);
    EXPECT_EQ(level(2), 1);
    EXPECT_EQ(level(3.9), 2);
    EXPECT_EQ(level(8), 3);
    EXPECT_EQ(level(30), 3) << "finer than the overview, which is level 4";
}

TEST(DetailChoice, nothing_is_finer_than_what_is_felt_and_an_overview_may_be_enough) {
    const stream::StoreInfo info = pyramid();
    const SeenBox seen{Vec3::Constant(100), Vec3::Constant(120), 0.1};
    EXPECT_EQ(level_for(seen_store(info, 2), seen, no_limits), 2);
    EXPECT_EQ(level_for(seen_store(info, 4), seen, no_limits), std::nullopt);
    EXPECT_EQ(level_for(seen_store(info, 5), seen, no_limits), std::nullopt);
}

TEST(DetailChoice, boxes_lie_in_their_level_hold_what_is_seen_and_are_within_the_limits) {
    Random random(3);
    const stream::StoreInfo info = pyramid();
    const SeenStore store = seen_store(info);
    const DetailLimits limits{300'000, 40'000'000, 200};
    int chosen = 0;
    for (int i = 0; i < 2000; ++i) {
        SeenBox seen = random_box(random);
        const int axis = random.below(3);
        seen.to[axis] = seen.from[axis];
        const auto level = level_for(store, seen, limits);
        if (!level) continue;
        ++chosen;
        const Geometry& grid = info.levels[std::size_t(*level)].geometry;
        EXPECT_TRUE(fits(store, *level, samples_in(grid, seen, Index3::Zero()), limits));
        const SampleBox box = slice_box(store, *level, seen, axis);
        EXPECT_EQ(united(box, whole_box(grid)), whole_box(grid));
        EXPECT_TRUE(has_slice(store, {*level, box}, seen, axis));
        // A small move needs nothing new, a large one does.
        SeenBox moved = seen;
        moved.from[axis] = moved.to[axis] = seen.to[axis] + 3 * grid.spacing[axis];
        EXPECT_TRUE(has_slice(store, {*level, box}, moved, axis));
        moved.from[axis] = moved.to[axis] = seen.to[axis] + 40 * grid.spacing[axis];
        const double last =
            physical_from_index(grid, (grid.size - Index3::Ones()).cast<double>())[axis];
        if (moved.to[axis] < last) {
            EXPECT_FALSE(has_slice(store, {*level, box}, moved, axis));
        }
        const auto boxes = coarse_to_fine(store, *level, box);
        EXPECT_EQ(boxes.back(), (stream::DetailBox{*level, box}));
        for (std::size_t b = 1; b < boxes.size(); ++b) {
            EXPECT_EQ(boxes[b - 1].level, boxes[b].level + 2);
            EXPECT_LT(boxes[b - 1].level, 4) << "the overview's";
        }
    }
    EXPECT_GT(chosen, 1000);
}

TEST(DetailChoice, thin_pieces_are_read_for_few_layers) {
    const stream::StoreInfo thick = pyramid(), thin = pyramid({512, 512, 1});
    const SeenBox seen{Vec3(100, 100, 500), Vec3(300, 300, 500), 1};
    const auto layers = [&](const stream::StoreInfo& info) {
        const SampleBox box = slice_box(seen_store(info), 0, seen, 2);
        return box.high[2] - box.low[2] + 1;
    };
    EXPECT_GE(layers(thick), 14);
    EXPECT_LE(layers(thin), 4);
}

TEST(PatchChoice, has_what_is_seen_in_whole_cells_within_the_limits) {
    Random random(11);
    const stream::StoreInfo info = pyramid();
    const SeenStore store = seen_store(info);
    const DetailLimits limits{2'000'000, 100'000'000, 400};
    int chosen = 0, all_seen = 0;
    for (int i = 0; i < 500; ++i) {
        SeenPoints seen;
        const Vec3 middle(random.uniform(0, 2060), random.uniform(0, 2060),
                          random.uniform(0, 2060));
        seen.half_height = std::exp2(random.uniform(2, 11));
        seen.pixel_mm = seen.half_height / 300;
        for (int p = 0; p < 60; ++p) {
            Vec3 at = middle;
            for (int a = 0; a < 3; ++a) at[a] += random.uniform(-1, 1) * seen.half_height;
            seen.points.push_back(at.cwiseMax(10).cwiseMin(2058));
        }
        seen.middle = seen.points.front();
        for (const auto way : {Interpolation::linear, Interpolation::cubic}) {
            const auto patch = patch_for(store, seen, way, limits);
            if (!patch) continue;
            ++chosen;
            EXPECT_TRUE(fits(store, patch->level, patch->box, limits));
            EXPECT_TRUE(is_enough(*patch, store, seen, way, limits));
            const double begin = way == Interpolation::cubic ? 0.5 : 0;
            int inside = 0;
            for (const Vec3& point : seen.points) {
                const Vec3 index = index_from_physical(store.overview, point);
                const bool in = (index.array() >= patch->low.array()).all() &&
                                (index.array() <= patch->high.array()).all();
                inside += in;
                // "Within a view's height of the middle."
                if ((point - seen.middle).norm() <= 2 * seen.half_height) {
                    EXPECT_TRUE(in);
                }
            }
            all_seen += inside == 60;
            const Geometry& grid = info.levels[std::size_t(patch->level)].geometry;
            for (int a = 0; a < 3; ++a) {
                if (std::isfinite(patch->low[a])) {
                    EXPECT_EQ(patch->low[a] + begin, std::round(patch->low[a] + begin));
                    Vec3 plane = Vec3::Zero();
                    plane[a] = patch->low[a];
                    const double at =
                        index_from_physical(grid, physical_from_index(store.overview, plane))[a];
                    EXPECT_LE(patch->box.low[a] + 2, at) << "two more samples";
                } else {
                    EXPECT_EQ(patch->box.low[a], 0);
                }
            }
        }
    }
    EXPECT_GT(chosen, 600);
    EXPECT_GT(all_seen, 200);
}

TEST(PatchChoice, a_patch_is_enough_until_the_view_leaves_it_or_deserves_another_level) {
    const stream::StoreInfo info = pyramid();
    const SeenStore store = seen_store(info);
    const DetailLimits limits{16'000'000, 1'000'000'000, 4000};
    SeenPoints seen;
    seen.half_height = 100;
    seen.pixel_mm = 2;
    seen.points = {Vec3(900, 900, 900), Vec3(1000, 1000, 1000)};
    seen.middle = seen.points.front();
    const auto patch = patch_for(store, seen, Interpolation::linear, limits);
    ASSERT_TRUE(patch);
    EXPECT_EQ(patch->level, 1);
    const auto enough = [&] {
        return is_enough(*patch, store, seen, Interpolation::linear, limits);
    };
    EXPECT_TRUE(enough());
    seen.points.back() += Vec3(3, 3, 3);
    EXPECT_TRUE(enough());
    seen.points.back() += Vec3(60, 0, 0);
    EXPECT_FALSE(enough());
    seen.points.back() = Vec3(1000, 1000, 1000);
    seen.pixel_mm = 0.5;
    EXPECT_FALSE(enough());
    seen.points.clear();
    EXPECT_FALSE(patch_for(store, seen, Interpolation::linear, limits)) << "nothing is seen";
}

TEST(PatchChoice, samples_are_the_fine_ones_inside_and_the_overviews_field_from_the_planes_on) {
    using support::grid;
    const Geometry coarse = grid({12, 12, 12}, Vec3::Constant(4), Vec3::Constant(1.5));
    const Geometry level = grid({48, 48, 48});
    for (const auto way : {Interpolation::linear, Interpolation::cubic}) {
        const Field overview(support::noise_of(SampleType::float32, coarse, 1), Solid::above, {},
                             way);
        PatchChoice patch;
        patch.box = {{0, 10, 12}, {36, 30, 40}};
        const double begin = way == Interpolation::cubic ? -0.5 : 0;
        patch.low = Vec3(-HUGE_VAL, 4 + begin, 4 + begin);
        patch.high = Vec3(8 + begin, 7 + begin, 9 + begin);
        Geometry part = level;
        part.size = patch.box.high - patch.box.low + Index3::Ones();
        part.origin = patch.box.low.cast<double>();
        const Volume fine = support::noise_of(SampleType::float32, part, 2);
        const Volume joined = joined_samples(fine, overview, patch);
        int kept = 0, replaced = 0;
        for (int k = 0; k < part.size[2]; ++k) {
            for (int j = 0; j < part.size[1]; ++j) {
                for (int i = 0; i < part.size[0]; ++i) {
                    const Index3 at(i, j, k);
                    const Vec3 point = physical_from_index(part, at.cast<double>());
                    const Vec3 index = index_from_physical(coarse, point);
                    const double inside =
                        std::min((index - patch.low).minCoeff(), (patch.high - index).minCoeff());
                    const double was = fine.sample(at), is = joined.sample(at);
                    const double field = value_at(overview, point);
                    if (inside >= 1) {
                        ++kept;
                        ASSERT_EQ(is, was);
                    } else if (inside <= 0) {
                        ++replaced;
                        ASSERT_NEAR(is, field, 1e-4);
                    } else {
                        ASSERT_GE(is, std::min(was, field) - 1e-4);
                        ASSERT_LE(is, std::max(was, field) + 1e-4);
                    }
                }
            }
        }
        EXPECT_GT(kept, 400);
        EXPECT_GT(replaced, 4000);
    }
}

}  // namespace
}  // namespace palpate::viewer
