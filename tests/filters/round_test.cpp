// A round of dequantization against the slow reference, on grids of all shapes and types.
#include "filters/round.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "palpate/scenes/volumes.hpp"
#include "support/dequantize.hpp"

namespace palpate::filters {
namespace {

/// Ranges of one row, backwards.
void row_by_row(int count, const std::function<void(int, int)>& work) {
    for (int row = count; row-- > 0;) work(row, row + 1);
}

void expect_round(const Volume& volume, RoundSettings settings) {
    settings.least = float(volume.minimum());
    settings.greatest = float(volume.maximum());
    support::Grid slow = support::grid_of(volume);
    std::vector<float> fast(slow.samples.begin(), slow.samples.end());
    int slices = 0;
    for (int round = 0; round < 3; ++round) {
        support::dequantize_once(slow, volume, settings.step, settings.half, settings.straight);
        run_round(volume, fast, settings, &row_by_row, [&] { ++slices; });
    }
    EXPECT_EQ(slices, 3 * volume.geometry().size[2]);
    double worst = 0;
    for (std::size_t i = 0; i < fast.size(); ++i) {
        worst = std::max(worst, std::abs(fast[i] - slow.samples[i]));
    }
    EXPECT_LT(worst, 2e-5 * volume.range()) << volume.geometry().size.transpose() << " "
                                            << name_of(volume.type()) << " step " << settings.step;
}

TEST(Round, is_the_formula_on_every_shape_of_grid_and_for_every_step) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    std::uint64_t seed = 1;
    for (const Index3& size : {Index3(1, 1, 1), Index3(2, 1, 3), Index3(1, 9, 2), Index3(7, 5, 9),
                               Index3(16, 3, 4), Index3(5, 17, 6), Index3(4, 4, 33)}) {
        for (const int step : {1, 2, 4, 16, 32}) {
            const Volume volume =
                scenes::noise(scenes::centred(size), SampleType::uint8, seed++, 9);
            expect_round(volume, {step, 0.5F, infinity});
            expect_round(volume, {step, 3.0F, 0.7F});
        }
    }
}

TEST(Round, is_the_formula_for_every_type_of_sample) {
    for (const SampleType type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        const double amplitude = type == SampleType::uint8 ? 255 : 30000;
        const Volume volume = scenes::noise(scenes::centred({9, 8, 7}), type, 3, amplitude);
        expect_round(volume, {2, 60.0F, 40.0F});
    }
}

}  // namespace
}  // namespace palpate::filters
