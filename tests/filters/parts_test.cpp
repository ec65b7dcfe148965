// Dequantization part by part has the bits of the whole volume at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include "palpate/filters/dequantize_parts.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"

namespace palpate::filters {
namespace {

SampleBox grown(const SampleBox& box, int by, const Index3& size) {
    return {(box.low.array() - by).max(0), (box.high.array() + by).min(size.array() - 1)};
}

std::size_t offset(const SampleBox& box, const Index3& at) {
    const Index3 size = box.high - box.low + Index3::Ones(), in = at - box.low;
    return (std::size_t(in[2]) * std::size_t(size[1]) + std::size_t(in[1])) * std::size_t(size[0]) +
           std::size_t(in[0]);
}

template <class Work>
void for_each(const SampleBox& box, Work&& work) {
    for (int k = box.low[2]; k <= box.high[2]; ++k) {
        for (int j = box.low[1]; j <= box.high[1]; ++j) {
            for (int i = box.low[0]; i <= box.high[0]; ++i) work(Index3(i, j, k));
        }
    }
}

Volume part_of(const Volume& volume, const SampleBox& box) {
    Geometry geometry = volume.geometry();
    geometry.size = box.high - box.low + Index3::Ones();
    return with_type(volume.type(), [&](auto zero) {
        std::vector<decltype(zero)> samples(std::size_t(sample_count(geometry)));
        for_each(box, [&](const Index3& at) {
            samples[offset(box, at)] = static_cast<decltype(zero)>(volume.sample(at));
        });
        return Volume(geometry, std::move(samples));
    });
}

std::vector<float> floats_of(const Volume& volume) {
    std::vector<float> samples;
    for_each({Index3::Zero(), volume.geometry().size - Index3::Ones()},
             [&](const Index3& at) { samples.push_back(float(volume.sample(at))); });
    return samples;
}

/// Boxes of at most `edge` samples that cover a grid.
std::vector<SampleBox> boxes(const Index3& size, int edge) {
    std::vector<SampleBox> all;
    const Index3 count = (size.array() + edge - 1) / edge;
    for_each({Index3::Zero(), count - Index3::Ones()}, [&](const Index3& box) {
        const Index3 low = box * edge;
        all.push_back({low, (low.array() + edge).min(size.array()) - 1});
    });
    return all;
}

std::vector<SurfaceSite> sites_by_parts(const Volume& volume, int edge, int step) {
    std::vector<SurfaceSite> sites;
    const Index3 size = volume.geometry().size;
    for (const SampleBox& box : boxes(size, edge)) {
        const SampleBox around = grown(box, 2 * step, size);
        const Volume part = part_of(volume, around);
        const auto found = sites_of({part, around.low, size}, box, step);
        sites.insert(sites.end(), found.begin(), found.end());
    }
    std::ranges::sort(sites, [](const SurfaceSite& a, const SurfaceSite& b) {
        return std::tie(a.at[2], a.at[1], a.at[0]) < std::tie(b.at[2], b.at[1], b.at[0]);
    });
    return sites;
}

Volume by_parts(const Volume& volume, int edge, const DequantizeOptions& options) {
    const Index3 size = volume.geometry().size;
    const auto plan = plan_of(level_of(volume).value(), volume.minimum(), volume.maximum(), options,
                              [&](int step) { return sites_by_parts(volume, edge, step); });
    const SampleBox whole{Index3::Zero(), size - Index3::Ones()};
    std::vector<std::int16_t> state(std::size_t(sample_count(volume.geometry())));
    for (const auto& rounds : plan.rounds) {
        std::vector<std::int16_t> next(state.size());
        for (const SampleBox& box : boxes(size, edge)) {
            const SampleBox around = grown(box, rounds.reach() + terrace_reach, size);
            const Volume part = part_of(volume, around);
            std::vector<std::int16_t> here(std::size_t(sample_count(part.geometry())));
            for_each(around, [&](const Index3& at) {
                here[offset(around, at)] = state[offset(whole, at)];
            });
            run_rounds({part, around.low, size}, here, plan, {&rounds, 1}, 1);
            for_each(box,
                     [&](const Index3& at) { next[offset(whole, at)] = here[offset(around, at)]; });
        }
        state = std::move(next);
    }
    return moved_samples(volume, state, plan);
}

void expect_same(const Volume& volume, int edge, const DequantizeOptions& options) {
    const Volume parts = by_parts(volume, edge, options), whole = dequantized(volume, options);
    ASSERT_EQ(parts.type(), whole.type());
    EXPECT_EQ(std::memcmp(parts.data(), whole.data(), whole.bytes()), 0)
        << volume.geometry().size.transpose() << " " << name_of(volume.type()) << " edge " << edge;
    const std::vector<float> before = floats_of(volume);
    EXPECT_NE(std::memcmp(before.data(), whole.data(), whole.bytes()), 0) << "nothing was done";
}

TEST(Parts, a_gentle_ball_in_boxes_of_any_size_has_the_bits_of_the_whole) {
    const Volume ball = scenes::ball({40, 37, 33});
    for (const int edge : {8, 13, 64}) expect_same(ball, edge, {.rounds = 5});
}

TEST(Parts, a_slope_of_every_type_and_every_coarsest_step_has_the_bits_of_the_whole) {
    const auto sample = [](const Index3& at) { return 20 + (3 * at[0] + 2 * at[1] + at[2]) / 7; };
    const auto expect_slope = [&](auto zero) {
        const Volume slope =
            support::volume_of<decltype(zero)>(scenes::centred({29, 18, 23}), sample);
        for (const int coarsest : {1, 4, 16}) {
            expect_same(slope, 9, {.rounds = 12, .coarsest = coarsest});
        }
    };
    expect_slope(std::uint8_t{});
    expect_slope(std::int16_t{});
    expect_slope(std::uint16_t{});
    expect_slope(float{});
}

TEST(Parts, bricks_with_and_without_terraces_have_the_bits_of_the_whole) {
    support::Random random(4);
    const auto sample = [&](const Index3& at) {
        const double x = at[0] - 40, y = at[1] - 30, z = at[2] - 35;
        const double r = std::sqrt(x * x + y * y + z * z);
        return std::uint8_t(r < 30 ? 120 - r : at[0] > 90 ? random.below(60) : 90);
    };
    expect_same(support::volume_of<std::uint8_t>(scenes::centred({130, 60, 70}), sample), 37,
                {.rounds = 10, .coarsest = 2});
}

TEST(Parts, a_mask_has_the_bits_of_the_whole) {
    const Geometry geometry = scenes::centred({30, 26, 22});
    std::vector<std::uint8_t> samples;
    for_each({Index3::Zero(), geometry.size - Index3::Ones()}, [&](const Index3& at) {
        samples.push_back(physical_from_index(geometry, at.cast<double>()).norm() < 9 ? 255 : 0);
    });
    expect_same({geometry, std::move(samples)}, 11, {.rounds = 6});
}

TEST(Parts, sites_of_parts_are_those_of_the_whole_in_every_number) {
    const Volume noise = scenes::noise(scenes::centred({90, 61, 47}), SampleType::int16, 8, 300);
    for (const int step : {2, 8}) {
        const Index3 size = noise.geometry().size;
        const auto whole =
            sites_of({noise, Index3::Zero(), size}, {Index3::Zero(), size - Index3::Ones()}, step);
        const auto parts = sites_by_parts(noise, 17, step);
        ASSERT_EQ(parts.size(), whole.size());
        EXPECT_GT(whole.size(), 5000U);
        for (std::size_t i = 0; i < whole.size(); ++i) {
            ASSERT_EQ(parts[i].at, whole[i].at);
            ASSERT_EQ(parts[i].slope, whole[i].slope);
            ASSERT_EQ(parts[i].bend, whole[i].bend);
        }
    }
}

}  // namespace
}  // namespace palpate::filters
