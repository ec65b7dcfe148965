// The strips that a round sweeps: all samples with terraces, each once, and little else.
#include "filters/strips.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/random.hpp"

namespace palpate::filters {
namespace {

MovedSamples grid_of(const Index3& size, const Index3& low, int step) {
    MovedSamples samples{size};
    samples.low = low;
    samples.step = step;
    return samples;
}

/// In how many strips each sample of a grid is, x fastest.
std::vector<int> times_in(const std::vector<Strip>& strips, const Index3& size) {
    std::vector<int> times(static_cast<std::size_t>(size.prod()));
    for (const Strip& strip : strips) {
        for (int z = strip.begin_z; z < strip.end_z; ++z) {
            for (int y = strip.begin_y; y < strip.end_y; ++y) {
                for (int x = strip.begin_x; x < strip.end_x; ++x) {
                    ++times[static_cast<std::size_t>((z * size[1] + y) * size[0] + x)];
                }
            }
        }
    }
    return times;
}

bool has_terraces(const TerracedBricks& bricks, const MovedSamples& samples, const Index3& at) {
    const auto brick = [&](int axis) { return bricks.brick_of(axis, samples, at[axis]); };
    return bricks.row(brick(1), brick(2))[brick(0)] != 0;
}

TEST(Strips, have_each_sample_with_terraces_once) {
    support::Random random(7);
    for (const int step : {1, 2, 4, 32}) {
        for (const Index3& low : {Index3(0, 0, 0), Index3(3, 15, 8)}) {
            const Index3 size(300 / step + 1, 70 / step + 1, 37 / step + 1);
            TerracedBricks bricks(size * step, low * step);
            for (int z = 0; z < bricks.count()[2]; ++z) {
                for (int y = 0; y < bricks.count()[1]; ++y) {
                    for (int x = 0; x < bricks.count()[0]; ++x) {
                        bricks.row(y, z)[x] = random.below(4) == 0;
                    }
                }
            }
            const MovedSamples samples = grid_of(size, low, step);
            const int begin = size[2] / 4, end = size[2];
            const auto times = times_in(strips_of(bricks, samples, begin, end), size);
            auto count = times.begin();
            for (int z = 0; z < size[2]; ++z) {
                for (int y = 0; y < size[1]; ++y) {
                    for (int x = 0; x < size[0]; ++x) {
                        const bool is = has_terraces(bricks, samples, {x, y, z});
                        const bool inside = z >= begin;
                        ASSERT_LE(*count, inside ? 1 : 0) << x << " " << y << " " << z;
                        ASSERT_TRUE(*count == 1 || !is || !inside) << x << " " << y << " " << z;
                        ++count;
                    }
                }
            }
        }
    }
}

TEST(Strips, are_cut_along_every_axis_where_there_are_no_terraces_between) {
    const Index3 size(256, 32, 32);
    TerracedBricks bricks(size, Index3::Zero());
    bricks.row(0, 0)[2] = bricks.row(1, 1)[2] = 1;    // one behind the other along y and z
    bricks.row(0, 0)[10] = bricks.row(0, 0)[11] = 1;  // and far along x
    const auto times = times_in(strips_of(bricks, grid_of(size, Index3::Zero(), 1), 0, 32), size);
    EXPECT_EQ(std::ranges::count(times, 1), 4 * 16 * 16 * 16);
}

TEST(Strips, stay_whole_where_cuts_cost_more_than_they_save) {
    const Index3 size(96, 32, 32);
    TerracedBricks bricks(size, Index3::Zero());
    for (int z = 0; z < 2; ++z) {
        for (int y = 0; y < 2; ++y) std::fill_n(bricks.row(y, z), 6, std::uint8_t{1});
    }
    bricks.row(0, 0)[3] = 0;
    EXPECT_EQ(strips_of(bricks, grid_of(size, Index3::Zero(), 1), 0, 32).size(), 1U);
}

}  // namespace
}  // namespace palpate::filters
