// Rounds of dequantization against the slow reference, on grids of all shapes and types, and the
// choice of bricks.
#include "filters/pyramid.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "palpate/scenes/volumes.hpp"
#include "support/dequantize.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"

namespace palpate::filters {
namespace {

void backwards(int count, const std::function<void(int)>& work) {
    for (int i = count; i-- > 0;) work(i);
}

/// The samples of a volume, not moved yet.
struct Moved {
    explicit Moved(const Volume& volume) : moved(std::size_t(sample_count(volume.geometry()))) {
        const Index3& size = volume.geometry().size;
        const std::ptrdiff_t slice = std::ptrdiff_t{size[0]} * size[1];
        samples = {size, nullptr, nullptr, moved.data(), slice, slice, size[0]};
        if (volume.type() == SampleType::float32) {
            samples.floats = volume.samples<float>().data();
            return;
        }
        support::Grid grid = support::grid_of(volume);
        for (const double s : grid.samples) whole.push_back(std::uint16_t(s - volume.minimum()));
        samples.whole = whole.data();
    }

    std::vector<std::uint16_t> whole;
    std::vector<std::int16_t> moved;
    MovedSamples samples{};
};

TerracedBricks some_bricks(const Index3& size, const Index3& low, std::uint64_t seed) {
    TerracedBricks bricks(size, low);
    support::Random random(seed);
    const Index3& count = bricks.count();
    for (int z = 0; z < count[2]; ++z) {
        for (int y = 0; y < count[1]; ++y) {
            for (int x = 0; x < count[0]; ++x) bricks.row(y, z)[x] = random.below(3) > 0;
        }
    }
    return bricks;
}

using Rounds = std::vector<DequantizePlan::Rounds>;
using Way = DequantizePlan::Rounds::Way;

/// For a box whose first sample is `low`, in which samples of some bricks move and others do not.
void expect_rounds(const Volume& volume, double level, bool mask, const Rounds& rounds,
                   const Index3& low = Index3::Zero()) {
    Moved fast(volume);
    fast.samples.low = low;
    const Index3& size = volume.geometry().size;
    const TerracedBricks bricks = some_bricks(size, low, 5);
    const auto moves = [&](const Index3& at) {
        const auto brick = [&](int axis) { return bricks.brick_of(axis, fast.samples, at[axis]); };
        return bricks.row(brick(1), brick(2))[brick(0)] != 0;
    };
    const DequantizePlan plan{level, volume.minimum(), volume.maximum(), mask, rounds};
    Pyramid pyramid(fast.samples, plan, bricks, &backwards);
    support::Grid slow = support::grid_of(volume);
    double done = 0, count = 0;
    for (const auto& some : rounds) {
        pyramid.run(some, [&](double part) { done += part; });
        count += some.count + int(some.way == Way::up);
        const support::Moving<decltype(moves)> moving{
            volume,
            some.step,
            some.way == Way::down ? 2 * some.step : some.step,
            low,
            (mask ? 127.0 / 256 : 511.0 / 1024) * level,
            (mask ? 0.05 : 0.55) * level,
            moves};
        if (some.way == Way::up) moving.refine(slow);
        for (int round = 0; round < some.count; ++round) moving.round(slow);
    }
    pyramid.go_to(1);
    EXPECT_NEAR(done, count, 1e-9);
    double worst = 0;
    std::size_t at = 0;
    slow.for_each([&](const Index3& index) {
        const double expected = (slow.samples[at] - volume.sample(index)) / level;
        worst = std::max(worst, std::abs(fast.moved[at] / 65536.0 - expected));
        if (!moves(index)) {
            ASSERT_EQ(fast.moved[at], 0) << index.transpose();
        }
        ++at;
    });
    EXPECT_LT(worst, 2e-4) << size.transpose() << " " << name_of(volume.type()) << " at "
                           << low.transpose();
}

const Rounds there_and_back = {
    {1, 1, Way::down}, {2, 1, Way::down}, {4, 2}, {2, 1, Way::up}, {1, 1, Way::up}};

TEST(Rounds, are_their_formula_on_every_shape_of_grid_and_for_every_step) {
    std::uint64_t seed = 1;
    for (const Index3& size :
         {Index3(1, 1, 1), Index3(2, 1, 3), Index3(1, 9, 2), Index3(7, 5, 9), Index3(16, 3, 4),
          Index3(5, 17, 6), Index3(4, 4, 33), Index3(35, 4, 3), Index3(3, 66, 2)}) {
        const Volume volume = scenes::noise(scenes::centred(size), SampleType::uint8, seed++, 9);
        expect_rounds(volume, 1, false, there_and_back);
        for (const int step : {1, 2, 16, 32}) expect_rounds(volume, 1, false, {{step, 2}});
        expect_rounds(volume, 9, true, there_and_back);
    }
}

TEST(Rounds, are_those_of_the_whole_volumes_grids_wherever_a_part_begins) {
    const Volume volume = scenes::noise(scenes::centred({40, 20, 36}), SampleType::uint8, 7, 3);
    for (const Index3& low : {Index3(3, 15, 8), Index3(16, 1, 31), Index3(5, 2, 7)}) {
        expect_rounds(volume, 1, false, {{1, 1, Way::down}, {2, 1}, {1, 1, Way::up}}, low);
    }
}

TEST(Rounds, are_their_formula_for_every_type_of_sample) {
    for (const SampleType type :
         {SampleType::uint8, SampleType::int16, SampleType::uint16, SampleType::float32}) {
        const double amplitude = type == SampleType::uint8 ? 255 : 30000;
        const Volume volume = scenes::noise(scenes::centred({9, 8, 7}), type, 3, amplitude);
        expect_rounds(volume, amplitude / 4, false, there_and_back);
    }
}

/// A gentle ramp, then a constant, then noise, each of 48 samples.
Volume ramp_and_noise() {
    support::Random random(3);
    return support::volume_of<std::uint8_t>(scenes::centred({144, 40, 40}), [&](const Index3& at) {
        if (at[0] >= 96) return std::uint8_t(100 + random.below(40));
        return std::uint8_t(100 - std::max(0, 48 - at[0]) / 3);
    });
}

TEST(TerracedBricks, are_those_of_gentle_slopes_and_of_what_is_constant_beside_them) {
    const Volume volume = ramp_and_noise();
    const Moved given(volume);
    const DequantizePlan plan{1, volume.minimum(), volume.maximum(), false, {}};
    const auto bricks = terraced_bricks(given.samples, plan, &backwards);
    for (int z = 0; z < 3; ++z) {
        for (int y = 0; y < 3; ++y) {
            const std::vector<int> row(bricks.row(y, z), bricks.row(y, z) + 9);
            EXPECT_EQ(row, (std::vector{1, 1, 1, 1, 0, 0, 0, 0, 0})) << y << " " << z;
        }
    }
}

TEST(TerracedBricks, are_all_that_a_masks_surface_crosses) {
    const Volume volume = scenes::box({48, 48, 80}, {20, 20, 20}, {27, 27, 27});
    const Moved given(volume);
    const DequantizePlan plan{255, volume.minimum(), volume.maximum(), true, {}};
    const auto bricks = terraced_bricks(given.samples, plan, &backwards);
    for (int z = 0; z < 5; ++z) {
        for (int y = 0; y < 3; ++y) {
            for (int x = 0; x < 3; ++x) EXPECT_EQ(bricks.row(y, z)[x], z < 3) << y << " " << z;
        }
    }
}

}  // namespace
}  // namespace palpate::filters
