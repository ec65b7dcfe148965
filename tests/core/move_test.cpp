// Proxy: the next move of method exact. The short cuts inside a tetrahedron and on one wall against
// the general projection in every incident tetrahedron.
#include "proxy/move.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "support/fields.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// A point of a field on any walls, a level at or above its density, and a vector to a target.
struct Case {
    LatticePoint point;
    double isovalue;
    bool contact;
    Vec3 h;
};

LatticePoint random_point(const Field& field, Random& random) {
    const Vec3 size = field.geometry().size.cast<double>();
    LatticePoint point = locate(random.point(-0.1, 1.1).cwiseProduct(size));
    if (random.chance(0.5)) {  // one wall
        point.folded = snap(point.folded, 1U << random.below(wall_count));
    } else {
        point.folded = snap(point.folded, static_cast<unsigned>(random.below(16)));
    }
    return point;
}

/// A vector to a target: in general position, along the axes and the mirrors, along the isosurface,
/// or on one of these but for rounding.
Vec3 random_vector(const Site& site, Random& random) {
    Vec3 h = random.direction();
    switch (random.below(5)) {
        case 0:
            h = Vec3(random.below(3) - 1, random.below(3) - 1, random.below(3) - 1);
            break;
        case 1:
            h = wall_normal(static_cast<unsigned>(random.below(wall_count)));
            break;
        case 2: {
            const Vec3 g = site.piece.gradient;
            if (!g.isZero(0)) h -= g * (h.dot(g) / g.squaredNorm());
            break;
        }
        default:
            break;
    }
    if (random.chance(0.3)) h += std::pow(10, random.uniform(-17, -2)) * random.direction();
    return std::pow(10, random.uniform(-9, 1)) * (random.chance(0.5) ? h : Vec3(-h));
}

Case random_case(const Field& field, Random& random) {
    const LatticePoint point = random_point(field, random);
    const double density = value_at(field, point);
    const bool contact = random.chance(0.9);
    const double isovalue = contact ? density : density + field.sign() * 0.1 * field.range();
    const Site site(field, isovalue, field.sign(), point);
    return {point, isovalue, contact, random_vector(site, random)};
}

bool equal_bits(const Vec3& a, const Vec3& b) {
    return std::bit_cast<std::array<std::uint64_t, 3>>(std::array{a[0], a[1], a[2]}) ==
           std::bit_cast<std::array<std::uint64_t, 3>>(std::array{b[0], b[1], b[2]});
}

std::vector<TestField> all_fields() {
    return {noise_field(),    noise_field(7, Solid::below), salt_field(),
            box_field(),      anisotropic_field(),          oblique_field(),
            terraces_field(), marschner_lobb_field(),       sheet_field(),
            offset_field()};
}

}  // namespace

TEST(Move, the_best_move_equals_the_general_projection_bit_for_bit) {
    int straight = 0, at_one_wall = 0, along_the_plane = 0, along_walls = 0, at_edges = 0,
        stuck = 0;
    for (const TestField& test : all_fields()) {
        Random random(141);
        for (int i = 0; i < scaled(30000); ++i) {
            const Case c = random_case(test.field, random);
            const unsigned on = walls_at(c.point.folded);
            if (on == 0) continue;
            SCOPED_TRACE(test.name + " seed 141 case " + std::to_string(i));
            const Site site(test.field, c.isovalue, test.field.sign(), c.point);
            const Move fast = best_move(site, on, c.contact, c.h);
            const Move slow = best_of_all(site, on, c.contact, c.h);
            ASSERT_TRUE(same_tetrahedron(fast.tetrahedron, slow.tetrahedron));
            ASSERT_TRUE(equal_bits(fast.step, slow.step))
                << fast.step.transpose() << " != " << slow.step.transpose();
            ASSERT_EQ(fast.gain, slow.gain);
            ASSERT_EQ(fast.walls, slow.walls);
            ASSERT_EQ(fast.straight, slow.straight);
            const bool one_wall = std::has_single_bit(on);
            straight += slow.straight;
            at_one_wall += one_wall;
            along_the_plane += one_wall && !slow.straight && slow.walls == 0;
            along_walls += slow.walls != 0;
            at_edges += !one_wall;
            stuck += slow.gain == 0;
        }
    }
    const int few = scaled(30000) / 20;
    for (const int count : {straight, at_one_wall, along_the_plane, along_walls, at_edges, stuck}) {
        EXPECT_GT(count, few);
    }
}
