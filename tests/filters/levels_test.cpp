// The distance between levels, and the output of info about terraces.
#include <gtest/gtest.h>

#include "palpate/filters/dequantize.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/fields.hpp"

namespace palpate::filters {
namespace {

template <class T>
Volume row_of(std::vector<T> samples) {
    Geometry geometry;
    geometry.size = {int(samples.size()), 1, 1};
    return {geometry, std::move(samples)};
}

using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;
using Shorts = std::vector<std::int16_t>;
using Floats = std::vector<float>;

TEST(Level, is_the_smallest_gap_between_values_that_occur) {
    EXPECT_EQ(level_of(row_of(Bytes{3, 4, 9})), 1);
    EXPECT_EQ(level_of(row_of(Bytes{0, 255, 0})), 255);
    EXPECT_EQ(level_of(row_of(Words{0, 257, 65535, 514})), 257);
    EXPECT_EQ(level_of(row_of(Words{0, 16, 33, 49})), 16);
    EXPECT_EQ(level_of(row_of(Shorts{-32768, 32767, -32760})), 8);
    EXPECT_NEAR(*level_of(row_of(Floats{0.1F, 0.2F, 0.5F, 0.7F})), 0.1, 1e-6);
    EXPECT_EQ(level_of(row_of(Floats{0, 1, 1})), 1);
}

TEST(Level, is_none_for_constant_and_for_continuous_data) {
    EXPECT_EQ(level_of(row_of(Bytes{7, 7, 7})), std::nullopt);
    EXPECT_EQ(level_of(row_of(Floats{0, 1, 2.3F, 7.7F})), std::nullopt);
    EXPECT_EQ(level_of(scenes::noise(scenes::centred({42, 42, 42}), SampleType::float32, 1, 1)),
              std::nullopt);
}

TEST(Terraces, are_wide_on_a_gentle_8_bit_slope_and_tilt_it_as_measured) {
    const auto terraces = terraces_of(scenes::ball(support::cube(64)));
    ASSERT_TRUE(terraces);
    EXPECT_FALSE(terraces->mask);
    EXPECT_TRUE(terraces->wide());
    EXPECT_NEAR(terraces->tilt, 12.6 / (255 * 1.4 / 64), 0.6);
}

TEST(Terraces, are_a_mask_of_two_values) {
    const auto terraces = terraces_of(scenes::box(support::cube(12), {3, 3, 3}, {8, 8, 8}));
    ASSERT_TRUE(terraces);
    EXPECT_EQ(terraces->level, 255);
    EXPECT_TRUE(terraces->mask);
    EXPECT_TRUE(terraces->wide());
}

TEST(Terraces, are_not_what_labels_have) {
    // Neighbours differ by one or by several, as organs do.
    Bytes labels;
    for (int i = 0; i < 24 * 24 * 24; ++i) {
        const Vec3 at = Vec3(i % 24, i / 24 % 24, i / 576) - Vec3::Constant(11.5);
        labels.push_back(at.norm() > 10 ? 0 : at.norm() > 6 ? 1 : at[0] < 0 ? 2 : 7);
    }
    const auto terraces = terraces_of({Geometry{.size = support::cube(24)}, labels});
    ASSERT_TRUE(terraces);
    EXPECT_TRUE(terraces->labels);
    EXPECT_FALSE(terraces->mask);
    EXPECT_GT(terraces->share, 0.5) << "what looks like terraces";
    EXPECT_FALSE(terraces->wide());
    EXPECT_EQ(reason_to_dequantize(*terraces), "");
}

TEST(Terraces, are_not_what_noise_or_fine_data_have) {
    const Geometry grid = scenes::centred(support::cube(32));
    EXPECT_FALSE(terraces_of(scenes::noise(grid, SampleType::uint8, 1, 6))->wide());
    EXPECT_FALSE(terraces_of(scenes::noise(grid, SampleType::uint8, 1, 255))->wide());
    EXPECT_FALSE(
        terraces_of(scenes::ball(support::cube(48), 0.35, 1.4, SampleType::uint16))->wide());
    EXPECT_EQ(terraces_of(scenes::noise(grid, SampleType::float32, 1, 1)), std::nullopt);
}

}  // namespace
}  // namespace palpate::filters
