// Which bricks hands need first, and at which level.
#include "stream/loader/interest.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "palpate/samples.hpp"
#include "support/constants.hpp"
#include "support/fields.hpp"

namespace palpate::stream {
namespace {

using namespace palpate::support;

TEST(Levels, are_the_coarser_the_more_bricks_a_hand_passes_while_one_comes) {
    EXPECT_EQ(levels_for(0, 0, 5), (LevelChoice{2, 0}));
    EXPECT_EQ(levels_for(2, 0.4, 5), (LevelChoice{2, 0}));
    EXPECT_EQ(levels_for(4, 0.4, 5), (LevelChoice{3, 1}));
    EXPECT_EQ(levels_for(40, 0.4, 5), (LevelChoice{5, 4}));
    EXPECT_EQ(levels_for(1e300, 1e300, 5), (LevelChoice{5, 5}));
    EXPECT_EQ(levels_for(40, 0.4, 0), (LevelChoice{0, 0}));
}

class WantedBricks : public testing::Test {
  protected:
    const Geometry geometry = grid({2000, 2000, 2000});
    const Index3 count = ResidentBricks(geometry.size).count();
    const Index3 at_proxy = ResidentBricks::brick_of({1000, 1000, 1000});
    const Index3 at_hand = ResidentBricks::brick_of({1100, 1000, 1000});
    std::vector<Index3> wanted;

    void look(double speed) {
        const Interest hand{Vec3(1000, 1000, 1000), Vec3(1100, 1000, 1000), Vec3(speed, 0, 0)};
        wanted = wanted_bricks(geometry, count, {&hand, 1}, 400, 0.5);
        EXPECT_LE(wanted.size(), 400U);
    }
    std::ptrdiff_t place(const Index3& brick) const {
        return std::ranges::find(wanted, brick) - wanted.begin();
    }
};

TEST_F(WantedBricks, of_a_slow_hand_what_it_is_in_comes_first_and_all_of_its_reach_is_wanted) {
    look(60);
    EXPECT_LT(place(at_proxy), 4);
    EXPECT_LT(place(at_hand), 4);
    for (const Index3& brick : bricks_round(geometry, {1100, 1000, 1000}, 100)) {
        EXPECT_LT(place(brick), std::ptrdiff_t(wanted.size())) << brick.transpose();
    }
}

TEST_F(WantedBricks, of_a_fast_hand_what_it_reaches_meanwhile_comes_before_what_it_leaves) {
    const Interest hand{Vec3(1000, 1000, 1000), Vec3(1000, 1000, 1000), Vec3(600, 0, 0)};
    wanted = wanted_bricks(geometry, count, {&hand, 1}, 400, 0.5);
    EXPECT_LT(place(at_proxy + Index3(4, 0, 0)), 8);
    EXPECT_LT(place(at_proxy + Index3(4, 0, 0)), place(at_proxy));
    EXPECT_LT(place(at_proxy), std::ptrdiff_t(wanted.size()));
}

TEST_F(WantedBricks, of_a_hand_that_left_its_proxy_behind_what_is_between_them_comes_first) {
    look(600);
    EXPECT_LT(place(at_proxy), 4);
    EXPECT_LT(place(at_hand), place(at_hand + Index3(2, 0, 0)));
    EXPECT_LT(place(at_hand + Index3(2, 0, 0)), std::ptrdiff_t(wanted.size()));
}

TEST_F(WantedBricks, a_hand_that_is_nowhere_wants_nothing) {
    const Interest broken{Vec3::Constant(not_a_number), Vec3(0, 0, 0)};
    EXPECT_TRUE(wanted_bricks(geometry, count, {&broken, 1}, 400, 0.5).empty());
}

}  // namespace
}  // namespace palpate::stream
