// The builders of difficult volumes: the promised properties of their samples.
#include <gtest/gtest.h>

#include <cmath>

#include "palpate/field.hpp"
#include "palpate/scenes/volumes.hpp"
#include "scenes/hash.hpp"
#include "scenes/random.hpp"

using namespace palpate;
using namespace palpate::scenes;

TEST(Random, is_the_published_xoshiro256) {
    std::uint64_t state = 1234567;
    EXPECT_EQ(splitmix64(state), 6457827717110365317u);
    EXPECT_EQ(splitmix64(state), 3203168211198807973u);
    Random random(1);
    double sum = 0;
    for (int i = 0; i < 10000; ++i) {
        const double u = random.uniform();
        ASSERT_TRUE(u >= 0 && u < 1);
        sum += u;
    }
    EXPECT_NEAR(sum / 10000, 0.5, 0.01);
}

TEST(Builders, noise_fills_its_amplitude_evenly_and_depends_on_the_seed_only) {
    const Geometry geometry = centred({40, 30, 20}, {0.5, 0.5, 2});
    for (const auto type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        const Volume volume = noise(geometry, type, 7, 200);
        double sum = 0;
        for (int k = 0; k < 20; ++k) {
            for (int j = 0; j < 30; ++j) {
                for (int i = 0; i < 40; ++i) sum += volume.sample({i, j, k});
            }
        }
        EXPECT_NEAR(sum / 24000, 100, 2);
        EXPECT_LT(volume.minimum(), 1);
        EXPECT_GT(volume.maximum(), 199);
        EXPECT_LE(volume.maximum(), 200);
    }
    const auto bytes = [&](std::uint64_t seed) {
        const Volume volume = noise(geometry, SampleType::uint8, seed, 255);
        return hash_of(volume.data(), volume.bytes());
    };
    EXPECT_EQ(bytes(7), bytes(7));
    EXPECT_NE(bytes(7), bytes(8));
}

TEST(Builders, salt_has_the_asked_fraction_of_full_voxels_and_nothing_between) {
    const Volume volume = salt({40, 40, 40}, 0.25, 1);
    int full = 0;
    for (const std::uint8_t s : volume.samples<std::uint8_t>()) {
        ASSERT_TRUE(s == 0 || s == 255);
        full += s == 255;
    }
    EXPECT_NEAR(full / 64000.0, 0.25, 0.01);
}

TEST(Builders, a_box_is_full_from_lo_to_hi_and_empty_elsewhere) {
    const Volume volume = box({8, 9, 10}, {2, 3, 4}, {5, 3, 9});
    for (int k = 0; k < 10; ++k) {
        for (int j = 0; j < 9; ++j) {
            for (int i = 0; i < 8; ++i) {
                const bool inside = i >= 2 && i <= 5 && j == 3 && k >= 4;
                ASSERT_EQ(volume.sample({i, j, k}), inside ? 255 : 0) << i << j << k;
            }
        }
    }
}

TEST(Builders, a_thin_shell_misses_most_samples_near_it) {
    const Volume volume = thin_shell({40, 40, 40}, 14, 0.3);
    int near_shell = 0, met = 0;
    for (int k = 0; k < 40; ++k) {
        for (int j = 0; j < 40; ++j) {
            for (int i = 0; i < 40; ++i) {
                const double away =
                    std::abs(std::hypot(std::hypot(i - 19.5, j - 19.5), k - 19.5) - 14);
                const double sample = volume.sample({i, j, k});
                ASSERT_NEAR(sample, std::max(0.0, 255 * (1 - away / 0.3)), 0.5 + 1e-9);
                near_shell += away < 0.5;
                met += sample > 127;
            }
        }
    }
    EXPECT_GT(met, 200);
    EXPECT_LT(met, near_shell / 2);
    EXPECT_THROW(thin_shell({4, 4, 4}, 1, 0), std::invalid_argument);
}

TEST(Builders, the_half_level_of_a_ball_is_its_surface) {
    const Volume volume = ball({50, 50, 50});
    EXPECT_EQ(volume.type(), SampleType::uint8);
    const Field field = linear_field(volume);
    EXPECT_NEAR(value_at(field, Vec3(0.35 * 50, 0, 0)), 127.5, 1.5);
    EXPECT_NEAR(value_at(field, Vec3(0, 0, -0.25 * 50)), 255 * (0.5 + 0.14), 1.5);
    EXPECT_EQ(volume.sample({0, 0, 0}), 0);
}

TEST(Builders, a_centred_grid_has_its_centre_at_the_origin) {
    const Geometry geometry = centred({5, 8, 1}, {0.5, 0.25, 3});
    EXPECT_EQ(physical_centre(geometry), Vec3(0, 0, 0));
    EXPECT_EQ(geometry.size, Index3(5, 8, 1));
}
