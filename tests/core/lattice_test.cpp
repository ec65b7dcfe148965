// The lattice: every point has a tetrahedron, walls are shared, the field is continuous.
#include <gtest/gtest.h>

#include <random>

#include "palpate/lattice.hpp"

using namespace palpate;

TEST(Lattice, a_located_point_is_the_point_it_was_located_from) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 1000; ++i) {
        Vec3 p;
        for (int a = 0; a < 3; ++a) p[a] = double(random() % 20000) / 1000 - 10;
        EXPECT_LT((index_of(locate(p)) - p).norm(), 1e-14);
    }
}
