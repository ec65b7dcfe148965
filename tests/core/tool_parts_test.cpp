// What a tool's update is made of: the nearest point of half-spaces, and how far a point may go.
#include <gtest/gtest.h>

#include "support/fields.hpp"
#include "support/random.hpp"
#include "tool_proxy/around.hpp"
#include "tool_proxy/nearest.hpp"

namespace palpate::tool {
namespace {

using support::Random;

Six random_six(Random& random, double size) {
    Six x;
    for (double& v : x) v = random.uniform(-size, size);
    return x;
}

/// Half-spaces that have a point in common, some of them parallel, some the same.
std::vector<HalfSpace6> random_half_spaces(Random& random) {
    std::vector<HalfSpace6> result(std::size_t(1 + random.below(most_half_spaces)));
    const Six common = random_six(random, 2);
    for (HalfSpace6& h : result) {
        h.row = random_six(random, 1);
        if (random.chance(0.2)) h.row = result[0].row;
        if (random.chance(0.1)) h.row = -result[0].row;
        if (random.chance(0.1)) h.row.tail<3>().setZero();
        h.bound = dot(h.row, common) - (random.chance(0.3) ? 0 : random.uniform(0, 1));
    }
    return result;
}

/// The conditions of Karush, Kuhn and Tucker, which only the minimum of a convex function meets.
void is_minimum(const Six& pull, const Mat6& m, const std::vector<HalfSpace6>& half_spaces,
                const Nearest& found) {
    ASSERT_TRUE(found.found);
    Six force = m * found.point - pull;
    for (std::size_t i = 0; i < half_spaces.size(); ++i) {
        const double room = dot(half_spaces[i].row, found.point) - half_spaces[i].bound;
        ASSERT_GE(room, -1e-9) << "in all half-spaces";
        ASSERT_GE(found.multiplier[i], 0);
        ASSERT_LE(found.multiplier[i] * room, 1e-7) << "held only by those it is on";
        force -= found.multiplier[i] * half_spaces[i].row;
    }
    ASSERT_LE(force.norm(), 1e-8 * (1 + pull.norm())) << "in equilibrium";
}

TEST(NearestOfHalfSpaces, is_in_equilibrium) {
    Random random(1);
    for (int i = 0; i < support::scaled(20000); ++i) {
        const auto half_spaces = random_half_spaces(random);
        const Six to = random_six(random, 4);
        is_minimum(to, Mat6::Identity(), half_spaces,
                   nearest(to, half_spaces.data(), int(half_spaces.size()), 1e-10));
        ASSERT_FALSE(testing::Test::HasFatalFailure()) << i;
    }
}

TEST(NearestOfHalfSpaces, is_in_equilibrium_with_a_matrix) {
    Random random(2);
    for (int i = 0; i < support::scaled(5000); ++i) {
        const auto half_spaces = random_half_spaces(random);
        Mat6 m = Mat6::Zero();
        for (int k = 0; k < 6; ++k) {
            const Six v = random_six(random, 1);
            m += v * v.transpose();
        }
        m += 0.6 * Mat6::Identity();
        const Six pull = random_six(random, 4);
        is_minimum(pull, m, half_spaces,
                   nearest(pull, m, 0.55, half_spaces.data(), int(half_spaces.size()), 1e-10));
        ASSERT_FALSE(testing::Test::HasFatalFailure()) << i;
    }
}

TEST(NearestOfHalfSpaces, says_where_there_is_none) {
    HalfSpace6 two[2];
    two[0].row = two[1].row = Six::Zero();
    two[0].row[2] = 1;
    two[0].bound = 1;
    two[1].row[2] = -1;
    two[1].bound = -0.5;
    EXPECT_FALSE(nearest(Six::Zero(), two, 2, 1e-12).found);
}

TEST(AroundATool, nothing_blocks_within_a_clearance) {
    Random random(3);
    for (const support::TestField& test :
         {support::noise_field(), support::noise_field(5, Solid::below), support::shell_field(),
          support::anisotropic_field(), support::oblique_field(),
          support::marschner_lobb_field()}) {
        const Field field = support::smooth(test.field);
        const Geometry& geometry = field.geometry();
        Surroundings known;
        renew(known, field);
        const int count = support::scaled(3000);
        Around around(field, test.isovalue, known, 100 * 1000 * 1000);
        double sum = 0;
        for (int i = 0; i < count; ++i) {
            Vec3 index;
            for (int a = 0; a < 3; ++a) index[a] = random.uniform(-8, geometry.size[a] + 8);
            const Vec3 from = physical_from_index(geometry, index);
            if (field.sign() * (value_at(field, from) - test.isovalue) > 0) continue;
            const double clearance = around.probe(from, from + Vec3(1e3, 0, 0)).clearance;
            sum += clearance;
            for (int k = 0; k < 10; ++k) {
                const Vec3 to = from + random.direction() * (clearance * random.uniform(0.8, 1));
                const double excess = field.sign() * (value_at(field, to) - test.isovalue);
                ASSERT_LE(excess / field.range(), Around::blocked) << test.name;
            }
        }
        EXPECT_GT(sum / count, 0.1 * geometry.spacing.minCoeff()) << test.name;
    }
}

TEST(AroundATool, a_chord_ends_where_the_surface_begins) {
    Random random(4);
    for (const support::TestField& test :
         {support::noise_field(), support::box_field(), support::oblique_field()}) {
        const Field field = support::smooth(test.field);
        const Geometry& geometry = field.geometry();
        Surroundings known;
        renew(known, field);
        Around around(field, test.isovalue, known, 100 * 1000 * 1000);
        const auto excess = [&](const Vec3& at) {
            return field.sign() * (value_at(field, at) - test.isovalue) / field.range();
        };
        int blocked = 0;
        for (int i = 0; i < support::scaled(3000); ++i) {
            Vec3 a, b;
            for (int k = 0; k < 3; ++k) {
                a[k] = random.uniform(-4, geometry.size[k] + 4);
                b[k] = random.uniform(-4, geometry.size[k] + 4);
            }
            const Vec3 from = physical_from_index(geometry, a);
            const Vec3 to = physical_from_index(geometry, b);
            if (excess(from) > 0) continue;
            const double part = around.free_part(from, to, Around::blocked);
            for (int k = 0; k <= 100; ++k) {
                ASSERT_LE(excess(from + (to - from) * (part * k / 100)), 3.1e-11) << test.name;
            }
            if (part == 1) continue;
            ++blocked;
            ASSERT_NEAR(excess(from + (to - from) * part), Around::blocked, 1e-11);
        }
        EXPECT_GT(blocked, support::scaled(3000) / 10) << test.name;
    }
}

}  // namespace
}  // namespace palpate::tool
