// Percentiles of histograms of durations, compared with those of sorted durations.
#include "palpate/exchange.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/random.hpp"

using namespace palpate;

namespace {

TEST(LatencyHistogram, is_all_zero_when_empty) {
    const LatencySummary summary = LatencyHistogram().summary();
    EXPECT_EQ(summary.count, 0U);
    EXPECT_EQ(summary.p50, 0);
    EXPECT_EQ(summary.max, 0);
}

TEST(LatencyHistogram, small_durations_are_exact) {
    LatencyHistogram histogram;
    for (int i = 1; i <= 15; ++i) histogram.add(i);
    EXPECT_EQ(histogram.summary().p50, 8);
    EXPECT_EQ(histogram.summary().max, 15);
}

TEST(LatencyHistogram, negative_durations_count_as_none) {
    LatencyHistogram histogram;
    histogram.add(-5);
    EXPECT_EQ(histogram.summary().count, 1U);
    EXPECT_EQ(histogram.summary().max, 0);
}

TEST(LatencyHistogram, percentiles_are_those_of_sorting_to_a_sixteenth) {
    support::Random random(3);
    for (int round = 0; round < 50; ++round) {
        LatencyHistogram histogram;
        std::vector<std::int64_t> sorted;
        for (int i = 0; i < 3000; ++i) {
            // From a nanosecond to minutes.
            const auto ns = static_cast<std::int64_t>(std::exp(random.uniform(0, 25)));
            histogram.add(ns);
            sorted.push_back(ns);
        }
        std::ranges::sort(sorted);
        const LatencySummary summary = histogram.summary();
        const auto expect = [&](double part, std::int64_t got) {
            const auto rank = static_cast<std::size_t>(std::ceil(part * 3000)) - 1;
            EXPECT_GE(got, sorted[rank]);
            EXPECT_LE(static_cast<double>(got), static_cast<double>(sorted[rank]) * 17 / 16);
        };
        expect(0.5, summary.p50);
        expect(0.99, summary.p99);
        expect(0.999, summary.p999);
        EXPECT_EQ(summary.max, sorted.back());
        EXPECT_EQ(summary.count, 3000U);
    }
}

TEST(LatencyHistogram, the_longest_durations_there_are_have_a_place) {
    LatencyHistogram histogram;
    histogram.add(std::numeric_limits<std::int64_t>::max());
    EXPECT_EQ(histogram.summary().p50, std::numeric_limits<std::int64_t>::max());
}

TEST(LatencyHistogram, counts_those_up_to_a_duration_to_a_sixteenth) {
    support::Random random(4);
    LatencyHistogram histogram;
    std::vector<std::int64_t> all;
    for (int i = 0; i < 3000; ++i) {
        all.push_back(static_cast<std::int64_t>(std::exp(random.uniform(0, 25))));
        histogram.add(all.back());
    }
    const auto reference = [&](double ns) {
        return static_cast<std::uint64_t>(std::ranges::count_if(
            all, [&](std::int64_t one) { return static_cast<double>(one) <= ns; }));
    };
    for (double ns = 1; ns < 1e11; ns *= 1.37) {
        const std::uint64_t count = histogram.count_to(static_cast<std::int64_t>(ns));
        EXPECT_LE(count, reference(ns)) << ns;
        EXPECT_GE(count, reference(std::floor(ns) * 15 / 16 - 1)) << ns;
    }
    EXPECT_EQ(histogram.count_to(std::int64_t{1} << 62), 3000U);
    EXPECT_EQ(histogram.count_to(-1), 0U);
}

}  // namespace
