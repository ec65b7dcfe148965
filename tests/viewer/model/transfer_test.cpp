// Transfer function presets: valid for any data, and where they should stand for data we know.
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "apps/viewer/model/sample_block.hpp"
#include "apps/viewer/model/transfer.hpp"
#include "tests/viewer/transfer_function.hpp"

namespace palpate::viewer {
namespace {

using Engine = std::mt19937_64;

double uniform(Engine& random, double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
}

template <class T>
Volume volume_of(const std::vector<T>& samples) {
    Geometry geometry;
    geometry.size = {static_cast<int>(samples.size()), 1, 1};
    return Volume(geometry, samples);
}

/// Samples of a few clusters; one cluster without width is a constant volume.
template <class T>
Volume random_volume(Engine& random, double low, double high) {
    const int clusters = std::uniform_int_distribution(1, 4)(random);
    std::vector<T> samples;
    for (int c = 0; c < clusters; ++c) {
        const double centre = uniform(random, low, high);
        const double width = random() % 3 == 0 ? 0 : uniform(random, 0, high - low);
        const int count = std::uniform_int_distribution(1, 200)(random);
        for (int i = 0; i < count; ++i) {
            const double value = centre + width * uniform(random, -0.5, 0.5);
            samples.push_back(static_cast<T>(std::clamp(value, low, high)));
        }
    }
    return volume_of(samples);
}

Volume any_volume(Engine& random) {
    switch (random() % 4) {
        case 0:
            return random_volume<std::uint8_t>(random, 0, 255);
        case 1:
            return random_volume<std::int16_t>(random, -32768, 32767);
        case 2:
            return random_volume<std::uint16_t>(random, 0, 65535);
        default: {
            const double size = std::pow(10.0, uniform(random, -30, 30));
            const double shift = random() % 2 ? 0 : 100 * size;
            return random_volume<float>(random, shift - size, shift + size);
        }
    }
}

TEST(Transfer, presets_of_any_data_are_valid_and_lie_within_the_data) {
    Engine random(5);
    for (int round = 0; round < 1500; ++round) {
        const Volume volume = any_volume(random);
        const int bins = std::uniform_int_distribution(1, 300)(random);
        const run::Histogram histogram = run::histogram_of(volume, bins);
        const auto names = preset_names(histogram, volume);
        for (const std::string& name : names) {
            const TransferFunction transfer = preset(name, histogram, volume);
            ASSERT_TRUE(is_valid(transfer)) << name << ", round " << round;
            EXPECT_EQ(transfer.preset, name);
            EXPECT_EQ(transfer.points.front().level, volume.minimum());
            EXPECT_GE(transfer.points.back().level, volume.maximum());
            EXPECT_GT(transfer.points.back().level, transfer.points.front().level);
        }
        EXPECT_NE(std::ranges::find(names, suggested_preset(histogram, volume)), names.end());
    }
}

TEST(Transfer, between_two_points_colour_and_opacity_run_straight_and_beyond_they_stay) {
    const TransferFunction transfer{
        "", {{10, {0, 0.2, 1}, 0}, {20, {1, 0.4, 0}, 0.5}, {40, {1, 1, 1}, 1}}};
    const ControlPoint middle = sampled(transfer, 15);
    EXPECT_EQ(middle.level, 15);
    EXPECT_DOUBLE_EQ(middle.opacity, 0.25);
    EXPECT_DOUBLE_EQ(middle.colour.red, 0.5);
    EXPECT_DOUBLE_EQ(middle.colour.green, 0.3);
    EXPECT_DOUBLE_EQ(middle.colour.blue, 0.5);
    EXPECT_EQ(sampled(transfer, 20).opacity, 0.5);
    EXPECT_EQ(sampled(transfer, -5), (ControlPoint{-5, {0, 0.2, 1}, 0}));
    EXPECT_EQ(sampled(transfer, 41), (ControlPoint{41, {1, 1, 1}, 1}));
}

TEST(Transfer, hounsfield_data_show_bone_and_hide_soft_tissue_as_bone_preset) {
    std::vector<std::int16_t> samples(2000, -1000);
    samples.insert(samples.end(), 900, 40);
    samples.insert(samples.end(), 200, 900);
    const Volume volume = volume_of(samples);
    const run::Histogram histogram = run::histogram_of(volume, 256);
    EXPECT_EQ(suggested_preset(histogram, volume), "CT bone");
    const TransferFunction bone = preset("CT bone", histogram, volume);
    EXPECT_EQ(sampled(bone, 40).opacity, 0);
    EXPECT_GT(sampled(bone, 600).opacity, 0.5);
    const TransferFunction skin = preset("CT skin", histogram, volume);
    EXPECT_EQ(sampled(skin, -1000).opacity, 0);
    EXPECT_GT(sampled(skin, 40).opacity, 0.5);
}

TEST(Transfer, without_hounsfield_units_the_classes_of_the_histogram_count) {
    std::vector<std::uint16_t> samples(2000, 5);
    samples.insert(samples.end(), 900, 300);
    samples.insert(samples.end(), 200, 700);
    const Volume volume = volume_of(samples);
    const run::Histogram histogram = run::histogram_of(volume, 256);
    EXPECT_EQ(sampled(preset("CT bone", histogram, volume), 300).opacity, 0);
    EXPECT_GT(sampled(preset("CT bone", histogram, volume), 690).opacity, 0.5);
    for (const std::string& name : preset_names(histogram, volume)) {
        if (name == "Grey") continue;  // a plain ramp
        EXPECT_EQ(sampled(preset(name, histogram, volume), 5).opacity, 0) << name;
        EXPECT_GT(sampled(preset(name, histogram, volume), 700).opacity, 0.2) << name;
    }
}

TEST(Transfer, presets_of_ct_are_for_data_that_look_like_hounsfield_units) {
    const auto offers_ct = [](const Volume& volume) {
        const auto names = preset_names(run::histogram_of(volume, 256), volume);
        const auto count = std::ranges::count_if(
            names, [](const std::string& name) { return name.starts_with("CT"); });
        EXPECT_TRUE(count == 0 || count == 3);
        return count > 0;
    };
    EXPECT_TRUE(offers_ct(volume_of<std::int16_t>({-1024, -1000, 0, 40, 900})));
    EXPECT_TRUE(offers_ct(volume_of<float>({-3024, -1000, 0, 40, 900})));
    std::vector<std::uint16_t> shifted(3000, 0);
    shifted.insert(shifted.end(), 1500, 1040);
    shifted.push_back(3000);
    EXPECT_TRUE(offers_ct(volume_of(shifted)));
    EXPECT_FALSE(offers_ct(volume_of<std::uint8_t>({0, 20, 200, 255})));
    EXPECT_FALSE(offers_ct(volume_of<float>({0, 0.4F, 0.6F, 1})));
    EXPECT_FALSE(offers_ct(volume_of<std::int16_t>({0, 300, 1200}))) << "MR";
    EXPECT_FALSE(offers_ct(volume_of<std::int16_t>({-32768, -900, 0, 32767}))) << "seismic";
}

TEST(Transfer, suggestions_follow_the_kind_of_data) {
    std::vector<std::uint16_t> shifted(3000, 0);  // CT stored as HU + 1000
    shifted.insert(shifted.end(), 1500, 1040);
    shifted.insert(shifted.end(), 300, 2000);
    shifted.push_back(3000);
    std::vector<std::uint8_t> cells(10000, 2);
    cells.insert(cells.end(), 200, 180);
    const std::vector<float> constant(10, 3.5F);
    const auto suggested = [](const Volume& volume) {
        return suggested_preset(run::histogram_of(volume, 256), volume);
    };
    EXPECT_EQ(suggested(volume_of(shifted)), "CT bone");
    EXPECT_EQ(suggested(volume_of(cells)), "Microscopy");
    EXPECT_EQ(suggested(volume_of(constant)), "Grey");
    std::vector<float> brain{0, 0, 0, 0, 0.4F, 0.5F, 0.6F, 1};
    EXPECT_EQ(suggested(volume_of(brain)), "MR");
}

TEST(Transfer, a_preset_that_there_is_not_is_refused) {
    const Volume volume = volume_of(std::vector<std::uint8_t>{0, 1});
    EXPECT_THROW(preset("Sepia", run::histogram_of(volume, 2), volume), std::invalid_argument);
}

}  // namespace
}  // namespace palpate::viewer
