// The tetrahedra at the SCP.
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "apps/viewer/scene/hand_marks.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"

namespace palpate::viewer {
namespace {

using support::Random;

std::size_t count_at(const Field& field, const Vec3& index) {
    return local_tetrahedra(field, locate(index), 0).size();
}

TEST(LocalTetrahedra, are_as_many_as_touch_the_point) {
    const Field field = support::box_field().field;
    EXPECT_EQ(count_at(field, Vec3(10.4, 10.3, 10.55)), 1U);  // inside one
    EXPECT_EQ(count_at(field, Vec3(10.0, 10.3, 10.55)), 2U);  // on a face of the cell
    EXPECT_EQ(count_at(field, Vec3(10.5, 10.5, 10.5)), 24U);  // the cell's centre
    EXPECT_EQ(count_at(field, Vec3(10.0, 10.5, 10.5)), 8U);   // the centre of a face
    EXPECT_EQ(count_at(field, Vec3(10.0, 10.0, 10.25)), 8U);  // on an edge of the cell
    EXPECT_EQ(count_at(field, Vec3(10.0, 10.0, 10.0)), 48U);  // a sample
}

TEST(LocalTetrahedra, contain_the_point_and_are_a_24th_of_a_voxel) {
    const support::TestField oblique = support::oblique_field();
    const double voxel = oblique.field.geometry().spacing.prod();
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        Vec3 index = random.point(1, 15);
        if (i % 2) index = (4 * index).array().round() / 4;  // onto walls, edges and corners
        const LatticePoint point = locate(index);
        const Vec3 scp = physical_from_index(oblique.field.geometry(), index_of(point));
        for (const LocalTetrahedron& t : local_tetrahedra(oblique.field, point, 33000.3)) {
            Mat3 edges;
            for (int e = 0; e < 3; ++e) edges.col(e) = t.corners[std::size_t(e) + 1] - t.corners[0];
            EXPECT_NEAR(std::abs(edges.determinant()) / 6, voxel / 24, 1e-9 * voxel);
            const Vec3 weights = edges.inverse() * (scp - t.corners[0]);
            EXPECT_GE(weights.minCoeff(), -1e-9);
            EXPECT_LE(weights.sum(), 1 + 1e-9);
        }
    }
}

/// Checks that the polygons are convex, with corners where the field that is felt has the isovalue.
void expect_on_isosurface(const support::TestField& test, const LocalTetrahedron& local,
                          double within) {
    for (const std::vector<Vec3>& polygon : local.patch) {
        const std::size_t n = polygon.size();
        ASSERT_TRUE(n == 3 || n == 4);
        Vec3 first = Vec3::Zero();
        for (std::size_t c = 0; c < n; ++c) {
            EXPECT_NEAR(value_at(test.field, polygon[c]), test.isovalue,
                        within * test.field.range());
            const Vec3 turn = (polygon[(c + 1) % n] - polygon[c])
                                  .cross(polygon[(c + 2) % n] - polygon[(c + 1) % n]);
            if (c == 0) first = turn;
            EXPECT_GE(turn.dot(first), -1e-6 * first.squaredNorm() - 1e-12);
        }
    }
}

TEST(LocalTetrahedra, patches_lie_on_the_isosurface_and_are_convex) {
    for (const support::TestField& test : {support::oblique_field(), support::noise_field()}) {
        Random random(2);
        int triangles = 0, quads = 0;
        for (int i = 0; i < 300; ++i) {
            const LatticePoint point = locate(random.point(1, 16));
            for (const LocalTetrahedron& t : local_tetrahedra(test.field, point, test.isovalue)) {
                if (t.patch.empty()) continue;
                ASSERT_EQ(t.patch.size(), 1U);
                (t.patch[0].size() == 3 ? triangles : quads)++;
                expect_on_isosurface(test, t, 1e-9);
            }
        }
        EXPECT_GT(triangles, 10);
        EXPECT_GT(quads, 10);
    }
}

TEST(LocalTetrahedra, patches_of_a_smooth_field_are_curved) {
    support::TestField test = support::oblique_field();
    test.field.set_interpolation(Interpolation::cubic);
    Random random(2);
    int curved = 0;
    for (int i = 0; i < 300; ++i) {
        const LatticePoint point = locate(Interpolation::cubic, random.point(1, 16));
        for (const LocalTetrahedron& t : local_tetrahedra(test.field, point, test.isovalue)) {
            expect_on_isosurface(test, t, 1e-4);
            curved += t.patch.size() > 1;
        }
    }
    EXPECT_GT(curved, 20);
}

TEST(LocalTetrahedra, planes_are_those_of_the_field_at_a_point_on_the_surface) {
    for (const Solid solid : {Solid::above, Solid::below}) {
        const Field field = support::oblique_field(9).field;
        const Field sided = linear_field(field.volume(), solid);
        Random random(3);
        for (int i = 0; i < 100; ++i) {
            const LatticePoint point = locate(random.point(1, 15));
            const double level = value_at(sided, point);
            const auto all = local_tetrahedra(sided, point, level);
            ASSERT_EQ(all.size(), 1U);
            ASSERT_TRUE(all[0].plane);
            const Vec3 scp = physical_from_index(sided.geometry(), index_of(point));
            EXPECT_LT((all[0].plane->point - scp).norm(), 1e-9);
            const Vec3 out = -sided.sign() * gradient_at(sided, scp).normalized();
            EXPECT_LT((all[0].plane->normal - out).norm(), 1e-6);
            EXPECT_FALSE(local_tetrahedra(sided, point, level + 0.01 * sided.range())[0].plane);
        }
    }
}

TEST(LocalTetrahedra, of_a_constant_field_have_neither_patch_nor_plane) {
    const Field field = linear_field(support::volume_of<std::uint8_t>(
        support::grid(support::cube(8)), [](const Index3&) { return 5; }));
    for (const LocalTetrahedron& t : local_tetrahedra(field, locate(Vec3(4, 4, 4)), 5)) {
        EXPECT_TRUE(t.patch.empty());
        EXPECT_FALSE(t.plane);
    }
}

}  // namespace
}  // namespace palpate::viewer
