// Levels and pixels, and the histogram over them.
#include "apps/viewer/panel/level_axis.hpp"

#include <gtest/gtest.h>

#include <QImage>
#include <QPainter>

#include <cmath>
#include <random>

namespace palpate::viewer {
namespace {

template <class T>
run::Histogram histogram_of(const std::vector<T>& samples, int bins = 256) {
    Geometry geometry;
    geometry.size = {static_cast<int>(samples.size()), 1, 1};
    return run::histogram_of(Volume(geometry, samples), bins);
}

/// Heights [pixels] of what is drawn in each column.
std::vector<int> heights(const run::Histogram& histogram, int width, int height) {
    QImage image(width, height, QImage::Format_ARGB32);
    image.fill(Qt::white);
    const QRectF plot(0, 0, width, height);
    QPainter painter(&image);
    paint_histogram(painter, histogram, axis_of(histogram, plot), plot, Qt::black);
    painter.end();
    std::vector<int> found(static_cast<std::size_t>(width), 0);
    for (int x = 0; x < width; ++x) {
        for (int y = 0; y < height; ++y) {
            if (qGray(image.pixel(x, y)) < 128) ++found[static_cast<std::size_t>(x)];
        }
    }
    return found;
}

TEST(LevelAxis, levels_come_back_from_their_pixels) {
    std::mt19937_64 random(2);
    for (int i = 0; i < 3000; ++i) {
        const double size = std::pow(10.0, std::uniform_real_distribution(-20.0, 20.0)(random));
        const double low = size * std::uniform_real_distribution(-5.0, 5.0)(random);
        const LevelAxis axis{low, low + size, 6, 306};
        const double level = low + size * std::uniform_real_distribution(0.0, 1.0)(random);
        ASSERT_NEAR(axis.level_of(axis.x_of(level)), level, 1e-9 * size);
        const double rounded = axis.round_level_of(axis.x_of(level));
        ASSERT_NEAR(rounded, level, 0.5001 * axis.step());
        ASSERT_LE(axis.step(), size / 300);
        ASSERT_GE(axis.step(), size / 3001);
    }
}

TEST(LevelView, zooming_keeps_what_is_under_the_pointer_and_stays_within_the_data) {
    std::mt19937_64 random(6);
    const LevelAxis whole{-1000, 3000, 6, 306};
    for (int round = 0; round < 300; ++round) {
        LevelView view;
        for (int i = 0; i < 20; ++i) {
            const LevelAxis before = view.seen(whole);
            const double x = std::uniform_real_distribution(6.0, 306.0)(random);
            const double level = before.level_of(x);
            const double factor = std::uniform_real_distribution(0.5, 2.0)(random);
            view.zoom(factor, (level + 1000) / 4000);
            const LevelAxis after = view.seen(whole);
            ASSERT_LT(after.low, after.high);
            ASSERT_GE(after.low, whole.low);
            ASSERT_LE(after.high, whole.high + 1e-9);
            // Zooming in never meets an end.
            if (factor > 1) {
                ASSERT_NEAR(after.x_of(level), x, 1e-6);
            }
            view.move(std::uniform_real_distribution(-2.0, 2.0)(random));
            const LevelAxis moved = view.seen(whole);
            ASSERT_NEAR(moved.high - moved.low, after.high - after.low, 1e-6);
            ASSERT_GE(moved.low, whole.low);
            ASSERT_LE(moved.high, whole.high + 1e-9);
        }
        view.zoom(1e-9, 0.3);
        ASSERT_EQ(view.seen(whole).low, whole.low);
        ASSERT_EQ(view.seen(whole).high, whole.high);
    }
}

TEST(LevelAxis, rounded_levels_have_short_numbers) {
    EXPECT_EQ(rounded_to(0.30000000000000004, 0.1), 0.3);
    EXPECT_EQ(rounded_to(1234.4, 10), 1230);
    EXPECT_EQ(rounded_to(-0.0761, 0.001), -0.076);
    EXPECT_EQ(rounded_to(5, 0), 5);
}

TEST(LevelAxis, whole_numbers_end_at_the_last_of_them) {
    std::vector<std::uint8_t> samples;
    for (int i = 0; i < 256; ++i) samples.push_back(static_cast<std::uint8_t>(i));
    const LevelAxis axis = axis_of(histogram_of(samples), QRectF(0, 0, 100, 10));
    EXPECT_EQ(axis.low, 0);
    EXPECT_EQ(axis.high, 255);
}

TEST(LevelAxis, ends_at_the_greatest_sample_however_wide_the_bins_are) {
    const LevelAxis axis =
        axis_of(histogram_of(std::vector<std::int16_t>{-1000, 5, 3071}), QRectF(0, 0, 100, 10));
    EXPECT_EQ(axis.low, -1000);
    EXPECT_EQ(axis.high, 3071);
}

TEST(LevelAxis, both_values_of_a_mask_are_drawn) {
    std::vector<std::uint8_t> mask(100, 0);
    mask.insert(mask.end(), 50, 1);
    const std::vector<int> found = heights(histogram_of(mask), 100, 50);
    EXPECT_EQ(found[20], 50);
    EXPECT_NEAR(found[80], 50 * std::log1p(50) / std::log1p(100), 1.5);
}

TEST(LevelAxis, a_constant_volume_is_one_bar_in_the_middle) {
    const run::Histogram histogram = histogram_of(std::vector<float>(10, 7.5F));
    const LevelAxis axis = axis_of(histogram, QRectF(0, 0, 100, 50));
    EXPECT_LT(axis.low, 7.5);
    EXPECT_GT(axis.high, 7.5);
    const std::vector<int> found = heights(histogram, 101, 50);
    EXPECT_EQ(found[50], 50);
    EXPECT_EQ(found[10], 0);
    EXPECT_EQ(found[90], 0);
}

TEST(LevelAxis, bars_are_as_high_as_the_logarithm_of_their_counts) {
    std::vector<float> samples;
    const int counts[] = {1, 10, 1000, 30};
    for (int bin = 0; bin < 4; ++bin) {
        for (int i = 0; i < counts[bin]; ++i) samples.push_back(0.5F + static_cast<float>(bin));
    }
    samples.push_back(0);
    samples.push_back(4);
    const std::vector<int> found = heights(histogram_of(samples, 4), 200, 100);
    EXPECT_NEAR(found[25], 100 * std::log1p(2) / std::log1p(1000), 1.5);
    EXPECT_NEAR(found[75], 100 * std::log1p(10) / std::log1p(1000), 1.5);
    EXPECT_EQ(found[125], 100);
    EXPECT_NEAR(found[175], 100 * std::log1p(31) / std::log1p(1000), 1.5);
}

}  // namespace
}  // namespace palpate::viewer
