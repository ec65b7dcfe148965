// The samples of the balls against the judge's formula.
#include "evaluation/virtual_store.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace palpate::evaluation {
namespace {

TEST(VirtualStore, has_the_samples_that_the_judge_goes_by) {
    const VirtualStore store({}, 1);
    for (const int level : {0, 2, 5}) {
        const Geometry& grid = store.info().levels[std::size_t(level)].geometry;
        const SampleBox box{Index3(100, 120, 130), Index3(140, 140, 140)};
        std::vector<std::byte> bytes(41 * 21 * 11);
        store.read(level, box, bytes, {});
        std::size_t at = 0;
        for (int k = box.low[2]; k <= box.high[2]; ++k) {
            for (int j = box.low[1]; j <= box.high[1]; ++j) {
                for (int i = box.low[0]; i <= box.high[0]; ++i, ++at) {
                    const double depth = ball_depth(physical_from_index(grid, Vec3(i, j, k)));
                    const double value = std::clamp(ball_isovalue + depth / 2, 0.0, 255.0);
                    ASSERT_NEAR(double(std::to_integer<int>(bytes[at])), value, 0.5 + 1e-9);
                }
            }
        }
    }
}

}  // namespace
}  // namespace palpate::evaluation
