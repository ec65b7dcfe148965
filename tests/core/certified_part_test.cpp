// The part of a straight motion that is certainly free: against the cubic's values along it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "proxy/cubic_site.hpp"

namespace palpate {
namespace {

using Bernstein = std::array<double, 4>;

long double value_of(const Bernstein& b, long double t) {
    const long double s = 1 - t;
    return s * s * s * b[0] + 3 * s * s * t * b[1] + 3 * s * t * t * b[2] + t * t * t * b[3];
}

/// The greatest value in [0, end].
long double greatest_until(const Bernstein& b, double end) {
    constexpr int steps = 400;
    long double most = b[0];
    for (int i = 1; i <= steps; ++i) most = std::max(most, value_of(b, end * i / steps));
    return most;
}

TEST(CertifiedPart, of_coefficients_that_are_nowhere_above_zero_is_all) {
    EXPECT_EQ(certified_part({-3, -2, -1, 0}, 1e-13), 1);
    EXPECT_EQ(certified_part({-3, -2, -1, -0.5}, 1e-13), 1);
    EXPECT_EQ(certified_part({-1, -4, 0, -2}, 1e-13), 1);
    EXPECT_EQ(certified_part({0, 0, 0, 0}, 1e-13), 1);
}

TEST(CertifiedPart, never_rises_above_zero_and_ends_where_more_would) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> coefficient(-1, 1);
    int rising = 0, ended = 0, whole = 0;
    for (int i = 0; i < 20000; ++i) {
        Bernstein b;
        for (double& c : b) c = coefficient(random);
        b[0] = -std::abs(b[0]);
        if (i % 2 == 0) std::sort(b.begin(), b.end());
        rising += i % 2 == 0;
        const double part = certified_part(b, 1e-13);
        ASSERT_GE(part, 0);
        ASSERT_LE(part, 1);
        ASSERT_LE(greatest_until(b, part), 1e-15L) << i;
        if (part == 1) {
            ++whole;
        } else {
            ++ended;
            ASSERT_NEAR(static_cast<double>(value_of(b, part)), 0, 1e-12) << i;
        }
    }
    EXPECT_GT(ended, 5000);
    EXPECT_GT(whole, 2000);
    EXPECT_GT(rising, 5000);
}

}  // namespace
}  // namespace palpate
