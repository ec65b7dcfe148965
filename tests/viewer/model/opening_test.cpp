// A volume made ready in the background.
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/model/transfer.hpp"
#include "palpate/io/error.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::viewer {
namespace {

using run::source_named;

TEST(Opening, every_sample_is_counted_and_progress_rises_to_the_end) {
    double last = 0;
    const Opened opened = open(source_named("synthetic:shepp-logan:32x32x32"), [&](double part) {
        EXPECT_GE(part, last);
        last = part;
    });
    EXPECT_EQ(last, 1);
    const auto& counts = opened.histogram.counts;
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::int64_t{0}), 32 * 32 * 32);
    EXPECT_LT(opened.dark(), opened.bright());
    EXPECT_GE(opened.dark(), opened.loaded.volume.minimum());
    EXPECT_LE(opened.bright(), opened.loaded.volume.maximum());
}

TEST(Opening, first_level_lies_within_the_data) {
    const Opened opened = open(source_named("synthetic:noise:16x16x16"), [](double) {});
    EXPECT_GT(first_isovalue(opened), opened.loaded.volume.minimum());
    EXPECT_LT(first_isovalue(opened), opened.loaded.volume.maximum());
}

TEST(Opening, a_background_does_not_decide_the_contrast) {
    std::vector<std::uint8_t> samples(4096, 0);
    for (std::size_t i = 0; i < 61; ++i) samples[i * 60] = static_cast<std::uint8_t>(100 + i);
    Volume cells(Geometry{.size = {16, 16, 16}}, samples);
    const Opened opened{{cells, source_named("cells"), "cells"}, run::histogram_of(cells, 256)};
    EXPECT_NEAR(opened.dark(), 100, 2);
    EXPECT_NEAR(opened.bright(), 160, 2);
}

/// Noise about `level`, and a few samples of something bright.
Opened sparse(double level, double noise, std::size_t bright) {
    std::mt19937 random(5);
    std::normal_distribution<double> background(level, noise);
    std::vector<std::uint16_t> samples(40 * 40 * 40);
    for (std::uint16_t& s : samples) {
        s = static_cast<std::uint16_t>(std::clamp(background(random), 0.0, 4000.0));
    }
    for (std::size_t i = 0; i < bright; ++i) {
        samples[i * 601 % samples.size()] = static_cast<std::uint16_t>(600 + 3000 * i / bright);
    }
    Volume cells(Geometry{.size = {40, 40, 40}}, samples);
    return {{cells, source_named("cells"), "cells"}, run::histogram_of(cells, 256)};
}

TEST(Opening, neither_does_one_with_noise_however_little_else_there_is) {
    for (const std::size_t bright : {40U, 128U, 1300U}) {
        SCOPED_TRACE(bright);
        const Opened opened = sparse(200, 20, bright);
        EXPECT_GT(opened.dark(), 200) << "the background is black";
        EXPECT_LT(opened.dark(), 700);
        EXPECT_GT(opened.bright(), 3200) << "and what is not background decides what is white";
    }
}

TEST(Opening, a_background_that_goes_over_into_tissue_ends_where_its_noise_does) {
    std::vector<std::uint16_t> samples(40 * 40 * 40);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const bool air = i % 5 < 3;
        samples[i] = static_cast<std::uint16_t>(air ? i * i % 60 : 3000 * (i % 997) / 997);
    }
    Volume head(Geometry{.size = {40, 40, 40}}, samples);
    const Opened opened{{head, source_named("head"), "head"}, run::histogram_of(head, 256)};
    EXPECT_LT(opened.dark(), 300);
    EXPECT_GT(opened.bright(), 2800);
}

TEST(Opening, each_label_of_a_map_is_seen_on_its_background) {
    std::vector<std::uint8_t> samples(4096, 0);
    for (std::size_t i = 0; i < 900; ++i) samples[i] = i < 500 ? 3 : 9;
    Volume labels(Geometry{.size = {16, 16, 16}}, samples);
    const Opened opened{{labels, source_named("map"), "map"}, run::histogram_of(labels, 256)};
    EXPECT_LT(opened.dark(), 1);
    EXPECT_EQ(opened.bright(), 9);
}

TEST(Opening, constant_data_are_refused_with_their_name) {
    Volume constant(Geometry{.size = {4, 4, 4}}, std::vector<std::uint8_t>(64, 9));
    const Opened opened{{constant, source_named("flat"), "flat"}, run::histogram_of(constant, 256)};
    try {
        (void)first_isovalue(opened);
        FAIL();
    } catch (const std::invalid_argument& e) {
        EXPECT_NE(std::string(e.what()).find("flat"), std::string::npos);
    }
    EXPECT_LE(opened.dark(), opened.bright());
}

TEST(Opening, a_file_that_is_not_there_is_an_input_error) {
    EXPECT_THROW((void)open(source_named("no-such-file.nrrd"), [](double) {}), io::InputError);
}

}  // namespace
}  // namespace palpate::viewer
