// Coarse versions of a field: their values, and the samples on which they depend.
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

#include "apps/viewer/model/sample_block.hpp"
#include "palpate/edit.hpp"
#include "support/fields.hpp"

namespace palpate::viewer {
namespace {

Field coarse_test_noise(const Geometry& geometry, Solid solid = Solid::above) {
    return linear_field(support::noise_volume<std::int16_t>(geometry, 5, -300, 1000), solid, -77);
}

TEST(CoarseSamples, are_between_mean_and_extreme_of_the_samples_round_them) {
    for (const Solid solid : {Solid::above, Solid::below}) {
        const Field field = coarse_test_noise(support::grid({23, 20, 18}, {1, 2, 0.5}), solid);
        const Index3 last = field.geometry().size - Index3::Ones();
        for (const int every : {2, 3, 4, 7}) {
            const Volume coarse = coarse_volume(field, every, 0.25);
            const Index3 size = coarse.geometry().size;
            EXPECT_EQ(size, coarse_size(field.geometry().size, every));
            EXPECT_EQ(coarse.geometry().spacing, every * field.geometry().spacing);
            EXPECT_EQ(coarse.geometry().origin, field.geometry().origin);
            const int half = every / 2, across = 2 * half + 1;
            for (int n = 0; n < int(sample_count(coarse.geometry())); ++n) {
                const Index3 at(n % size[0], n / size[0] % size[1], n / (size[0] * size[1]));
                double sum = 0, weights = 0, most = -1e300;
                for (int m = 0; m < across * across * across; ++m) {
                    const Index3 by =
                        Index3(m % across, m / across % across, m / (across * across)) -
                        Index3::Constant(half);
                    const double sample =
                        field.samples().sample((every * at + by).cwiseMax(0).cwiseMin(last));
                    // Half of a sample that lies half way along each axis.
                    const auto halves = (2 * by.cwiseAbs().array() == every).count();
                    const double weight = std::pow(0.5, double(halves));
                    sum += weight * sample;
                    weights += weight;
                    most = std::max(most, field.sign() * sample);
                }
                ASSERT_NEAR(coarse.sample(at), 0.75 * sum / weights + 0.25 * field.sign() * most,
                            1e-3);
            }
        }
    }
}

TEST(CoarseSamples, that_a_box_changes_are_all_that_depend_on_it) {
    support::Random random(5);
    const Field field = coarse_test_noise(support::grid({33, 31, 34}));
    for (int i = 0; i < 60; ++i) {
        const int every = 1 + i % 9;
        Index3 low;
        for (int a = 0; a < 3; ++a) low[a] = int(random.uniform(0, 30));
        const SampleBox box{low, low + Index3::Constant(i % 3)};
        Field now = field;
        now.use(edited(now.shared_samples(), edit::Fill{box, 999}).samples);
        const Volume before = coarse_volume(field, every, 0.5),
                     after = coarse_volume(now, every, 0.5);
        const SampleBox part = coarse_part(box, field.geometry().size, every);
        const Index3 size = before.geometry().size;
        for (int n = 0; n < int(sample_count(before.geometry())); ++n) {
            const Index3 at(n % size[0], n / size[0] % size[1], n / (size[0] * size[1]));
            if (before.sample(at) == after.sample(at)) continue;
            ASSERT_TRUE((at.array() >= part.low.array()).all() &&
                        (at.array() <= part.high.array()).all())
                << every << ": " << at.transpose();
        }
    }
}

}  // namespace
}  // namespace palpate::viewer
