// Proxy: the SCP after an update, compared with the true field sampled densely around it.
#include <gtest/gtest.h>

#include "support/fields.hpp"
#include "support/hand.hpp"
#include "support/paper_lattice.hpp"

#include "palpate/proxy.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

/// The excess by the slow reference, relative to the range.
double slow_excess(const TestField& test, const Vec3& index) {
    const Field& field = test.field;
    return field.sign() * (paper_value(field, index) - test.isovalue) / field.range();
}

}  // namespace

TEST(Proxy, ends_at_a_local_optimum_of_the_true_field) {
    // No point that a straight free path from the SCP reaches is closer to the HIP: thousands of
    // random points each, at all distances up to half a voxel, by the slow reference alone.
    for (const TestField& test : {noise_field(), salt_field(), anisotropic_field(), oblique_field(),
                                  terraces_field(), marschner_lobb_field()}) {
        const Geometry& geometry = test.field.geometry();
        Hand hand(geometry, 131);
        Random random(132);
        Proxy proxy;
        proxy.isovalue = test.isovalue;
        int optima = 0;
        std::int64_t closer = 0;
        for (int i = 0; optima < scaled(300); ++i) {
            const Vec3 hip = hand.next();
            const ProxyUpdate r = update_exact(proxy, test.field, hip);
            if (r.mode != Mode::constrained || i % 5 != 0) continue;
            ++optima;
            const Vec3 from = index_from_physical(geometry, r.scp);
            const double reached = (r.scp - hip).norm();
            for (int k = 0; k < 2000; ++k) {
                const double length = 0.5 * std::pow(10, random.uniform(-3, 0));
                const Vec3 to = from + length * random.direction();
                const Vec3 physical = physical_from_index(geometry, to);
                if ((physical - hip).norm() > reached - 1e-4 * length) continue;
                ++closer;
                if (slow_excess(test, to) > 1e-9) continue;
                const double greatest = greatest_on_segment(
                    from, to, 1, [&](const Vec3& index) { return slow_excess(test, index); });
                ASSERT_GT(greatest, 1e-9)
                    << test.name << " seeds 131 132 update " << i << ": a free way of " << length
                    << " voxels leads closer to " << hip.transpose();
            }
        }
        EXPECT_GT(closer, scaled(300) * 200);
    }
}

TEST(Proxy, reaches_the_hip_where_the_straight_way_is_free) {
    for (const TestField& test : {noise_field(), shell_field(), oblique_field()}) {
        const Geometry& geometry = test.field.geometry();
        Random random(133);
        int free_ways = 0;
        for (int i = 0; i < scaled(20000); ++i) {
            const Vec3 size = geometry.size.cast<double>();
            const Vec3 a = random.point(-0.1, 1.1).cwiseProduct(size);
            const Vec3 b = a + random.uniform(0, 3) * random.direction();
            const double greatest = greatest_on_segment(
                a, b, 1, [&](const Vec3& index) { return slow_excess(test, index); });
            if (greatest > -1e-9) continue;
            ++free_ways;
            Proxy proxy;
            ASSERT_TRUE(place(proxy, test.field, physical_from_index(geometry, a), test.isovalue));
            const Vec3 hip = physical_from_index(geometry, b);
            const ProxyUpdate r = update_exact(proxy, test.field, hip);
            ASSERT_EQ(r.scp, hip) << test.name << " seed 133 way " << i;
            ASSERT_EQ(r.mode, Mode::free);
            ASSERT_EQ(r.status, UpdateStatus::done);
        }
        EXPECT_GT(free_ways, scaled(20000) / 20);
    }
}

TEST(Proxy, ends_at_the_nearest_point_of_a_convex_body) {
    // A half-space and a wedge have closed forms: the nearest point in millimetres, not in voxels.
    const Geometry geometry = grid(cube(24), {0.5, 0.5, 2}, {3, -8, 40}, oblique_direction());
    Vec3 normal(1, 2, 0.5);
    normal /= std::sqrt(5.25);
    const Vec3 centre = physical_centre(geometry);
    const Field field = linear_field(volume_of<float>(geometry, [&](const Index3& i) {
        return -normal.dot(physical_from_index(geometry, i.cast<double>()) - centre);
    }));
    Random random(134);
    for (int i = 0; i < scaled(5000); ++i) {
        const auto near_centre = [&] {
            const Vec3 index = Vec3::Constant(11.5) + random.point(-5, 5);
            return physical_from_index(geometry, index);
        };
        Vec3 start = near_centre();
        start -= std::min(0.0, normal.dot(start - centre) - 0.1) * normal;
        const Vec3 hip = near_centre();
        Proxy proxy;
        ASSERT_TRUE(place(proxy, field, start, 0));
        const double depth = std::min(0.0, normal.dot(hip - centre));
        // The samples are floats: the plane is flat to their rounding.
        ASSERT_LE((update_exact(proxy, field, hip).scp - (hip - depth * normal)).norm(), 2e-4);
    }
}
