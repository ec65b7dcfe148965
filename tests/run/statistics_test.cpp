// Histogram, padding and suggested levels.
#include "palpate/run/statistics.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "palpate/io/sample_volume.hpp"
#include "palpate/io/volume_file.hpp"
#include "support/fields.hpp"

using namespace palpate;
using namespace palpate::run;
using namespace palpate::support;

namespace {

/// A body of 40 and bone of 400 to 1100 in air of -1000, as CT has them, with noise; outside the
/// scanner's circle as `outside` says.
Volume scan(double outside) {
    Random random(1);
    return volume_of<std::int16_t>(grid({64, 64, 8}), [&](const Index3& i) {
        const double r = std::hypot(i[0] - 31.5, i[1] - 31.5);
        if (r > 32) return outside;
        if (r > 20) return -1000 + random.uniform(0, 40);
        if (r > 12) return random.uniform(0, 80);
        return random.uniform(400, 1100);
    });
}

TEST(Gradients, are_those_of_the_samples_by_millimetre) {
    Geometry geometry = grid({24, 20, 16});
    geometry.spacing = {0.5, 0.5, 2};
    const Volume ramp = volume_of<float>(geometry, [](const Index3& i) { return 3.0 * i[0]; });
    const Histogram h = gradients_of(ramp, 64);
    EXPECT_EQ(h.low, 0);
    EXPECT_GT(h.greatest, 6) << "the border adds steeper ones";
    const double bin = (h.high - h.low) / 64;
    const auto at = static_cast<std::size_t>(6.0 / bin);
    std::int64_t all = 0;
    for (const std::int64_t count : h.counts) all += count;
    EXPECT_EQ(all, 24 * 20 * 16);
    std::int64_t near = h.counts[at] + (at > 0 ? h.counts[at - 1] : 0);
    EXPECT_GE(near, 22 * 18 * 14) << "all inner samples: 3 in half a millimetre";
}

TEST(Gradients, of_a_large_grid_are_those_of_some_samples_and_constant_data_have_none) {
    const Volume constant = volume_of<std::uint8_t>(grid({128, 128, 64}), [](auto) { return 7.0; });
    const Histogram h = gradients_of(constant, 16);
    EXPECT_GT(h.counts[0], 50'000);
    EXPECT_LT(h.counts[0], 300'000);
    EXPECT_EQ(h.counts[0], std::accumulate(h.counts.begin(), h.counts.end(), std::int64_t{0}));
    EXPECT_GT(h.high, h.low);
}

TEST(SuggestedIsovalues, what_an_object_was_put_into_comes_last) {
    Histogram h{0, 256, std::vector<std::int64_t>(256), 0, 0, true, 255};
    h.counts[2] = 4800;
    h.counts[116] = 300;
    h.counts[17] = 4900;  // resin, as in a scan of a lobster
    const std::vector<double> in_resin = suggested_isovalues(h);
    ASSERT_EQ(in_resin.size(), 2U);
    EXPECT_GT(in_resin[0], 17);
    EXPECT_LT(in_resin[1], 17);
    h.counts[17] = 0;
    h.counts[60] = 4900;  // flesh
    const std::vector<double> flesh = suggested_isovalues(h);
    EXPECT_LT(flesh[0], 60);
    EXPECT_GT(flesh[1], 60);
    h.counts[60] = 0;
    h.counts[17] = 500;  // a thin skin
    EXPECT_LT(suggested_isovalues(h)[0], 17);
}

}  // namespace

TEST(Padding, of_a_scan_is_left_out_of_histogram_mean_and_levels) {
    const Volume plain = scan(-1000);
    const std::vector<double> levels = suggested_isovalues(histogram_of(plain, 256));
    ASSERT_EQ(levels.size(), 2U);
    EXPECT_NEAR(levels[0], -480, 40) << "between air and body";
    for (const double value : {-2000.0, -3024.0, -32768.0}) {
        const Volume padded = scan(value);
        const auto padding = padding_of(padded);
        ASSERT_TRUE(padding);
        EXPECT_EQ(*padding, value);
        const Histogram h = histogram_of(padded, 256, padding);
        EXPECT_GE(h.low, -1000);
        EXPECT_GT(h.mean, -1000);
        const auto found = suggested_isovalues(h);
        ASSERT_EQ(found.size(), 2U);
        for (int i = 0; i < 2; ++i) EXPECT_NEAR(found[i], levels[i], 40) << value;
        // Without that, the levels would bound the circle.
        EXPECT_LT(suggested_isovalues(histogram_of(padded, 256))[0], -900) << value;
    }
}

TEST(Padding, and_histograms_are_counted_until_progress_throws) {
    struct Cancelled {};
    Geometry geometry;
    geometry.size = {1024, 1024, 1};
    std::vector<std::int16_t> samples(std::size_t{1} << 20, 5);
    samples.front() = -1000;
    samples.back() = 7;
    const Volume volume(geometry, std::move(samples));
    const OnProgress cancel = [](double) { throw Cancelled(); };
    EXPECT_THROW((void)padding_of(volume, -1000, cancel), Cancelled);
    EXPECT_THROW((void)histogram_of(volume, 16, {}, cancel), Cancelled);
    EXPECT_THROW((void)histogram_of(volume, 16, -1000, cancel), Cancelled);
}

TEST(Padding, is_not_what_is_only_the_least_value) {
    EXPECT_FALSE(padding_of(scan(-1000)));
    EXPECT_FALSE(padding_of(noise_field().field.volume()));
    const auto of = [](const std::vector<float>& values) {
        return padding_of(volume_of<float>(grid({10, 10, 10}), [&](const Index3& i) {
            return values[static_cast<std::size_t>(i.sum()) % values.size()];
        }));
    };
    EXPECT_FALSE(of({0, 50, 60, 70})) << "an empty background at 0";
    EXPECT_FALSE(of({-1, 1})) << "a mask";
    EXPECT_FALSE(of({-1, -1, -1})) << "constant";
    EXPECT_TRUE(of({-9, 1, 2, 3}));
    // One odd sample is none.
    EXPECT_FALSE(padding_of(volume_of<float>(grid({20, 20, 20}), [](const Index3& i) {
        return i == Index3(3, 3, 3) ? -900 : i.sum();
    })));
}

TEST(Padding, that_the_header_names_needs_no_gap) {
    const Volume close = scan(-1060);
    EXPECT_FALSE(padding_of(close));
    EXPECT_EQ(padding_of(close, -1060), std::optional(-1060.0));
    EXPECT_FALSE(padding_of(close, -1000)) << "not the least one";
}

TEST(Padding, of_the_sample_volume_there_is_none) {
    EXPECT_FALSE(padding_of(io::read_volume(io::sample_volume_path()).volume));
}
