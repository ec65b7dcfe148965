// Proxy: straight rays that meet the isosurface.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "palpate/proxy.hpp"
#include "support/fields.hpp"
#include "support/paper_lattice.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

double excess_at(const TestField& test, const Vec3& p) {
    const Field& field = test.field;
    return field.sign() * (value_at(field, p) - test.isovalue) / field.range();
}

/// The greatest excess on a segment, exactly.
double greatest_excess(const TestField& test, const Vec3& a, const Vec3& b) {
    const Geometry& geometry = test.field.geometry();
    const double greatest = greatest_on_segment(
        index_from_physical(geometry, a), index_from_physical(geometry, b), test.field.sign(),
        [&](const Vec3& index) { return value_at(test.field, locate(index)) - test.isovalue; });
    return greatest / test.field.range();
}

}  // namespace

TEST(Ray, meets_a_plane_exactly) {
    const Geometry geometry = grid(cube(20), {0.5, 0.7, 2}, {5, 6, -7}, oblique_direction());
    const Field field = linear_field(
        volume_of<float>(geometry, [](const Index3& i) { return i[2]; }), Solid::below);
    Random random(61);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 above = random.point(2, 17).cwiseMax(Vec3(0, 0, 9));
        const Vec3 below = random.point(2, 17).cwiseMin(Vec3(20, 20, 8));
        const Vec3 from = physical_from_index(geometry, above);
        const Vec3 to = physical_from_index(geometry, below);
        const RayHit ray = cast_ray(field, 8.3, from, to);
        ASSERT_TRUE(ray.hit);
        const double t = (above[2] - 8.3) / (above[2] - below[2]);
        ASSERT_LE((ray.point - (from + t * (to - from))).norm(), 1e-10);
        ASSERT_LE((ray.normal - geometry.direction.col(2)).norm(), 1e-10);
        // In the other direction it starts in the solid.
        const RayHit inside = cast_ray(field, 8.3, to, from);
        ASSERT_TRUE(inside.hit);
        ASSERT_EQ(inside.point, to);  // without rounding
    }
}

TEST(Ray, meets_the_first_surface_and_none_where_there_is_none) {
    for (const TestField& test :
         {noise_field(), salt_field(), anisotropic_field(), oblique_field(), shell_field(),
          noise_field(7, Solid::below), marschner_lobb_field()}) {
        Random random(62);
        const Geometry& geometry = test.field.geometry();
        int hits = 0;
        int passes = 0;
        int inside = 0;
        for (int i = 0; i < scaled(20000); ++i) {
            const Vec3 size = geometry.size.cast<double>();
            const Vec3 a = random.point(-0.2, 1.2).cwiseProduct(size);
            const bool is_short = random.chance(0.7);
            const Vec3 b = is_short ? Vec3(a + random.uniform(0, 2) * random.direction())
                                    : Vec3(random.point(-0.2, 1.2).cwiseProduct(size));
            const Vec3 from = physical_from_index(geometry, a);
            const Vec3 to = physical_from_index(geometry, b);
            const RayHit ray = cast_ray(test.field, test.isovalue, from, to);
            SCOPED_TRACE(test.name + " seed 62 ray " + std::to_string(i));
            if (excess_at(test, from) > 1e-9) {
                ++inside;
                ASSERT_TRUE(ray.hit);
                ASSERT_LE((ray.point - from).norm(), 1e-9);
                continue;
            }
            ASSERT_LE(greatest_excess(test, from, ray.point), 1e-9);
            if (!ray.hit) {
                ++passes;
                ASSERT_EQ(ray.point, to);
                continue;
            }
            ++hits;
            ASSERT_NEAR(excess_at(test, ray.point), 0, 1e-9);
            // On the segment, and what follows rises.
            const Vec3 way = to - from;
            const double t = (ray.point - from).dot(way) / way.squaredNorm();
            ASSERT_LE((from + t * way - ray.point).norm(), 1e-9);
            ASSERT_NEAR(ray.normal.norm(), 1, 1e-12);
        }
        EXPECT_GT(hits, scaled(20000) / 20);
        EXPECT_GT(passes, scaled(20000) / 20);
        EXPECT_GT(inside, scaled(20000) / 200);
    }
}

TEST(Ray, passes_far_background_in_a_few_pieces) {
    const TestField test = box_field();
    const Vec3 centre = physical_centre(test.field.geometry());
    Random random(63);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 far = 1e6 * random.direction();
        // A budget of one crossing of the volume: a million voxels cell by cell would not do.
        const RayHit ray = cast_ray(test.field, test.isovalue, centre + far, centre, 200);
        ASSERT_TRUE(ray.hit);
        ASSERT_NEAR(excess_at(test, ray.point), 0, 1e-9);
        EXPECT_LE((ray.point - centre).norm(), 6.1 * std::sqrt(3));
        // Beside the volume, a ray meets nothing.
        const Vec3 aside = far.unitOrthogonal() * 60;
        const RayHit past =
            cast_ray(test.field, test.isovalue, centre + far + aside, centre - far + aside, 200);
        ASSERT_FALSE(past.hit);
        ASSERT_EQ(past.point, centre - far + aside);
    }
}

TEST(Ray, from_any_distance_meets_what_lies_on_its_line) {
    const TestField test = box_field();
    const Vec3 centre = physical_centre(test.field.geometry());
    Random random(64);
    for (const double distance : {1e8, 1e10, 1e12}) {
        for (int i = 0; i < 200; ++i) {
            const Vec3 way = random.direction(), far = distance * way;
            const RayHit near = cast_ray(test.field, test.isovalue, centre + 100 * way, centre);
            for (const Vec3& end : {Vec3(centre - far), centre}) {
                const RayHit ray = cast_ray(test.field, test.isovalue, centre + far, end);
                ASSERT_TRUE(ray.hit);
                ASSERT_LE((ray.point - near.point).norm(), 1e-14 * distance);
            }
            const Vec3 aside = way.unitOrthogonal() * 60;
            EXPECT_FALSE(
                cast_ray(test.field, test.isovalue, centre + far + aside, centre + aside).hit);
        }
    }
    // If the background is solid, a ray is in it from its start.
    const Field solid = linear_field(test.field.volume(), Solid::above, 1e9);
    for (const Vec3& from : {Vec3(1e12, 0, 0), Vec3(1e12, 1e12, 0)}) {
        const RayHit ray = cast_ray(solid, test.isovalue, from, Vec3(0, 1e12, 0));
        EXPECT_TRUE(ray.hit);
        EXPECT_EQ(ray.point, from);
    }
    EXPECT_FALSE(
        cast_ray(test.field, test.isovalue, Vec3::Constant(-1e308), Vec3::Constant(1e308)).hit);
}

TEST(Ray, out_of_a_body_that_fills_the_grid_leaves_by_its_border) {
    // Solid below: the body is where the density is under the isovalue, the background above it.
    const Field field =
        linear_field(volume_of<std::uint8_t>(grid(cube(8)), [](const Index3&) { return 10; }),
                     Solid::below, 90.0);
    const RayHit ray = cast_ray(field, 50, Vec3(3.5, 3.5, 12), Vec3(3.5, 3.5, 3));
    ASSERT_TRUE(ray.hit);
    EXPECT_LE((ray.point - Vec3(3.5, 3.5, 7.5)).norm(), 1e-12);
    EXPECT_LE((ray.normal - Vec3::UnitZ()).norm(), 1e-12);
}

TEST(Ray, with_ends_that_are_not_finite_is_no_hit) {
    const TestField test = noise_field();
    const Vec3 bad(0, std::nan(""), 0);
    EXPECT_FALSE(cast_ray(test.field, 128, bad, Vec3::Zero()).hit);
    EXPECT_FALSE(cast_ray(test.field, 128, Vec3::Constant(-5), bad).hit);
    EXPECT_FALSE(cast_ray(test.field, 128, Vec3::Constant(-5), Vec3(1e300, 0, 0)).hit);
}
