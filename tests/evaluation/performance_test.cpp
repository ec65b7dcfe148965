// performance, in its quick mode, and what its numbers rest on: the hand, the clockwork, the
// synthetic neuron.
#include <algorithm>
#include <cmath>

#include "evaluation/claims.hpp"
#include "evaluation/hand_at_work.hpp"
#include "evaluation/performance/neuron.hpp"
#include "evaluation/timing.hpp"

namespace palpate::evaluation {
namespace {

TEST(Performance, quick_mode_bears_out_its_claims) {
    const Result result = quick_result(performance);
    EXPECT_EQ(result.claims.size(), 2U);
    EXPECT_EQ(result.table.rows().size(), 8U);  // 2 volumes, 2 resolutions, 2 methods
    EXPECT_EQ(result.table.number(0, "paper_mean_us"), 52);
    EXPECT_EQ(result.table.number(2, "paper_mean_us"), 72);
    EXPECT_TRUE(std::isnan(result.table.number(4, "paper_mean_us")));
}

TEST(Performance, same_seed_gives_the_same_table_but_for_the_times) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("torus:40x40x20"));
    const Table once = performance(options).table, again = performance(options).table;
    options.seed = 2;
    const Table other = performance(options).table;
    bool differs = false;
    for (std::size_t i = 0; i < once.rows().size(); ++i) {
        for (const char* column : {"speed_mm_s", "constrained_share", "depth_mm", "updates",
                                   "tetrahedra_per_update", "unfinished_updates"}) {
            EXPECT_EQ(once.number(i, column), again.number(i, column)) << column;
            differs = differs || once.number(i, column) != other.number(i, column);
        }
    }
    EXPECT_TRUE(differs);
}

TEST(Performance, a_body_too_ragged_for_the_hand_is_noted_not_claimed) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("noise:32x32x32"));
    std::string notes;
    options.note = [&](const std::string& text) { notes += text; };
    EXPECT_EQ(performance(options).claims.size(), 1U);
    EXPECT_NE(notes.find("very small"), std::string::npos);
}

TEST(HandAtWork, comes_within_two_percent_of_the_manner_that_is_wanted) {
    const Subject torus = synthetic("torus");
    for (const double share : {0.3, 0.8}) {
        HandAtWork hand;
        hand.strokes = 4;
        const Tuned at_work = tuned(torus, hand, {30, share});
        EXPECT_NEAR(at_work.manner.speed_mm_s, 30, 0.02 * 30);
        EXPECT_NEAR(at_work.manner.constrained_share, share, 0.02 * share);
        const Manner again = manner_of(torus, at_work.strokes, hand.rate_hz);
        EXPECT_EQ(again.constrained_share, at_work.manner.constrained_share);
    }
}

TEST(HandAtWork, is_never_faster_than_its_swelling_speed) {
    const Subject noise = synthetic("noise:24x24x24");
    HandAtWork hand;
    hand.strokes = 2;
    for (const Stroke& stroke : work(noise, hand)) {
        EXPECT_EQ(stroke.size(), 5001U);
        for (std::size_t i = 1; i < stroke.size(); ++i) {
            EXPECT_LE((stroke[i] - stroke[i - 1]).norm(), 1.8 * 0.05 + 1e-12);
        }
    }
}

TEST(HandAtWork, presses_more_lightly_on_a_body_too_fine_for_it) {
    HandAtWork hand;
    hand.strokes = 4;
    hand.speed_mm_s = 150;
    hand.depth_mm = 6;
    const Tuned at_work = tuned(synthetic("torus:40x40x20"), hand, {150, 0.9});
    EXPECT_LT(at_work.hand.depth_mm, 6);
    EXPECT_NEAR(at_work.manner.constrained_share, 0.9, 0.15 * 0.9);
}

TEST(HandAtWork, a_level_without_a_surface_is_refused) {
    EXPECT_THROW(work(synthetic("sphere", 500), {}), std::invalid_argument);
    EXPECT_THROW(work(synthetic("sphere", -5), {}), std::invalid_argument);
}

TEST(UpdateTimes, counts_are_the_methods_own_and_percentiles_are_in_order) {
    const Subject sphere = synthetic("sphere:32x32x32");
    HandAtWork hand;
    hand.strokes = 2;
    hand.stroke_s = 0.5;
    const auto strokes = work(sphere, hand);
    const UpdateTimes times = time_updates(sphere, &update_exact, strokes, {3, 5});
    std::int64_t tetrahedra = 0, constrained = 0;
    for (const Stroke& stroke : strokes) {
        Proxy proxy;
        place(proxy, sphere.field, stroke.front(), sphere.isovalue);
        for (std::size_t i = 1; i < stroke.size(); ++i) {
            const ProxyUpdate update = update_exact(proxy, sphere.field, stroke[i]);
            tetrahedra += update.tetrahedra;
            constrained += update.mode == Mode::constrained;
        }
    }
    EXPECT_EQ(times.updates, 1000);
    EXPECT_EQ(times.tetrahedra, tetrahedra);
    EXPECT_EQ(times.constrained, constrained);
    EXPECT_GT(times.p50_ns, 0);
    EXPECT_LE(times.p50_ns, times.p99_ns);
    EXPECT_LE(times.p99_ns, times.p999_ns);
    EXPECT_LE(times.p999_ns, times.max_ns);
    EXPECT_LE(times.max_ns, times.interrupted_max_ns);
    EXPECT_GT(times.cold_p50_ns, 0);
}

TEST(UpdateTimes, a_quantile_is_the_least_value_that_its_share_does_not_exceed) {
    std::vector<double> values{4, 1, 3, 2};
    EXPECT_EQ(quantile(values, 0.5), 2);
    EXPECT_EQ(quantile(values, 0.51), 3);
    EXPECT_EQ(quantile(values, 1), 4);
    EXPECT_EQ(quantile(values, 0), 1);
    std::vector<double> none;
    EXPECT_TRUE(std::isnan(quantile(none, 0.5)));
}

TEST(SyntheticNeuron, is_sparse_branching_and_the_same_every_time) {
    const Subject neuron = synthetic_neuron({160, 140, 20}, 3);
    const auto samples = neuron.field.volume().samples<std::uint8_t>();
    const auto solid =
        std::count_if(samples.begin(), samples.end(), [](std::uint8_t s) { return s > 64; });
    EXPECT_GT(solid, 500);
    EXPECT_LT(double(solid), 0.1 * double(samples.size()));
    const Subject again = synthetic_neuron({160, 140, 20}, 3);
    const auto same = again.field.volume().samples<std::uint8_t>();
    EXPECT_TRUE(std::equal(samples.begin(), samples.end(), same.begin(), same.end()));
    const Subject other = synthetic_neuron({160, 140, 20}, 4);
    const auto different = other.field.volume().samples<std::uint8_t>();
    EXPECT_FALSE(std::equal(samples.begin(), samples.end(), different.begin(), different.end()));
}

}  // namespace
}  // namespace palpate::evaluation
