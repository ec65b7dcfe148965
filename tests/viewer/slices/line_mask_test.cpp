// Smooth lines in a mask.
#include "apps/viewer/slices/line_mask.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/random.hpp"

namespace palpate::viewer {
namespace {

double covered(const LineMask& mask) {
    double sum = 0;
    for (int y = 0; y < mask.height(); ++y) {
        for (int x = 0; x < mask.width(); ++x) sum += mask.row(y)[x] / 255.0;
    }
    return sum;
}

TEST(LineMask, covers_as_much_as_the_line_is_large_in_any_direction) {
    support::Random random(3);
    for (int i = 0; i < 50; ++i) {
        LineMask mask(200, 200);
        const double angle = random.uniform(0, 7), length = random.uniform(20, 80);
        const double dx = length * std::cos(angle), dy = length * std::sin(angle);
        mask.draw(100, 100, 100 + dx, 100 + dy, 1.5);
        const double area = 3 * length + 3.14159 * 1.5 * 1.5;
        EXPECT_NEAR(covered(mask), area, 0.06 * area);
    }
}

TEST(LineMask, the_same_line_twice_or_in_pieces_is_the_same) {
    LineMask once(50, 50), twice(50, 50);
    once.draw(5.3, 7.1, 44, 31, 0.8);
    twice.draw(5.3, 7.1, 44, 31, 0.8);
    twice.draw(5.3, 7.1, 44, 31, 0.8);
    for (int y = 0; y < 50; ++y) {
        for (int x = 0; x < 50; ++x) EXPECT_EQ(once.row(y)[x], twice.row(y)[x]);
    }
}

TEST(LineMask, what_is_far_outside_or_far_longer_than_the_picture_does_no_harm) {
    LineMask mask(20, 10);
    mask.draw(-50, -50, -40, 90, 1);
    mask.draw(1e9, 3, 2e9, 3, 1);
    EXPECT_EQ(covered(mask), 0);
    mask.draw(-1e9, 5, 1e9, 5, 1);
    EXPECT_NEAR(covered(mask), 2 * 20, 2);
    mask.draw(5, 5, 5, 5, 1);  // a dot
    mask.draw(std::nan(""), 5, 5, 5, 1);
    LineMask nothing(0, 0);
    nothing.draw(0, 0, 5, 5, 1);
}

}  // namespace
}  // namespace palpate::viewer
