// Proxy: recovery from inside the solid after the isovalue or the field changed, or when a session
// starts there, and placing.
#include <gtest/gtest.h>

#include <cmath>

#include "support/fields.hpp"
#include "support/guarantees.hpp"
#include "support/hand.hpp"
#include "support/proxy_state.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

double excess_at(const Field& field, const Vec3& p, double isovalue) {
    return field.sign() * (value_at(field, p) - isovalue) / field.range();
}

/// A block of 255 at lo..hi along each axis of a grid of `edge`, 0 around.
Field block_field(int edge, int lo, int hi) {
    return linear_field(volume_of<std::uint8_t>(grid(cube(edge)), [&](const Index3& i) {
        return (i.array() >= lo).all() && (i.array() <= hi).all() ? 255 : 0;
    }));
}

/// Updates until the proxy is out; how many that took, or -1.
int updates_until_out(Proxy& proxy, const Field& field, const Vec3& hip, int most,
                      const ProxySettings& settings = {}) {
    for (int i = 1; i <= most; ++i) {
        const ProxyUpdate r = update_exact(proxy, field, hip, settings);
        if (r.status != UpdateStatus::recovering) return i;
    }
    return -1;
}

struct RecoverPath {
    std::vector<Vec3> points;
    StepObserver observer() {
        return {[](const Step& step, void* self) {
                    if (step.kind == StepKind::recover) {
                        static_cast<RecoverPath*>(self)->points.push_back(step.point);
                    }
                },
                this};
    }
};

}  // namespace

TEST(Recovery, keeps_the_guarantees_when_the_isovalue_moves_under_the_proxy) {
    for (TestField test : {noise_field(), anisotropic_field(), oblique_field(),
                           marschner_lobb_field(), noise_field(7, Solid::below), salt_field()}) {
        Guarantees checked(test.field, update_exact);
        Hand hand(test.field.geometry(), 51);
        Random random(52);
        Proxy proxy;
        proxy.isovalue = test.isovalue;
        for (int i = 0; i < scaled(60000) && !HasFailure(); ++i) {
            SCOPED_TRACE(test.name + " seeds 51 52 update " + std::to_string(i));
            if (i % 5 == 0) {
                const double off = random.uniform(-0.25, 0.25);
                proxy.isovalue = test.isovalue + off * test.field.range();
            }
            checked.update(proxy, hand.next());
        }
        checked.print(test.name);
        EXPECT_GT(checked.tally().recovered, checked.tally().updates / 100);
        EXPECT_LT(checked.tally().recovering, checked.tally().updates / 100);
        EXPECT_EQ(checked.tally().out_of_budget, 0);
    }
}

TEST(Recovery, keeps_the_guarantees_when_the_field_is_swapped_under_the_proxy) {
    const std::array<TestField, 3> fields{noise_field(1), noise_field(8), salt_field()};
    std::vector<Guarantees> checked;
    for (const TestField& f : fields) checked.emplace_back(f.field, update_exact);
    Hand hand(fields[0].field.geometry(), 53);
    Proxy proxy;
    proxy.isovalue = 128;
    int recovered = 0;
    for (int i = 0; i < scaled(60000) && !HasFailure(); ++i) {
        SCOPED_TRACE("seed 53 update " + std::to_string(i));
        checked[i / 4 % 3].update(proxy, hand.next());
    }
    for (const Guarantees& c : checked) recovered += c.tally().recovered;
    EXPECT_GT(recovered, scaled(60000) / 50);
}

TEST(Recovery, leads_downhill_where_the_gradient_leads_out) {
    const TestField test = marschner_lobb_field();
    Random random(54);
    int paths = 0;
    for (int i = 0; i < scaled(4000); ++i) {
        Proxy proxy;
        const Vec3 hip = physical_from_index(test.field.geometry(), random.point(2, 37));
        if (excess_at(test.field, hip, test.isovalue) < 0.01) continue;
        proxy.isovalue = test.isovalue;
        RecoverPath path;
        const ProxyUpdate r = update_exact(proxy, test.field, hip, {}, path.observer());
        ASSERT_EQ(r.status, UpdateStatus::done);
        ASSERT_LE(std::abs(excess_at(test.field, r.scp, test.isovalue)), 1e-9);
        double last = excess_at(test.field, hip, test.isovalue);
        Vec3 from = hip;
        bool jumped = false;
        for (const Vec3& p : path.points) {
            const double voxels = (p - from).norm() / 0.8;
            // A step of descent stays in one tetrahedron; the search along 26 directions jumps.
            jumped |= voxels > 1;
            if (jumped) break;
            for (int k = 1; k <= 4; ++k) {
                const double now =
                    excess_at(test.field, from + k / 4.0 * (p - from), test.isovalue);
                ASSERT_LE(now, last + 1e-12) << "uphill at " << p.transpose();
                last = now;
            }
            from = p;
        }
        paths += !jumped && path.points.size() > 2;
    }
    EXPECT_GT(paths, scaled(4000) / 20);
}

TEST(Recovery, starts_in_the_direction_in_which_the_field_falls_steepest_per_millimetre) {
    for (const TestField& test :
         {noise_field(), anisotropic_field(), noise_field(7, Solid::below)}) {
        const Geometry& geometry = test.field.geometry();
        Random random(59);
        int compared = 0;
        for (int i = 0; i < scaled(2000); ++i) {
            // Samples, edges and walls, where up to 48 tetrahedra offer a direction.
            const Vec3 index = (2 * random.point(2, 13)).array().round() / 2;
            const Vec3 hip = physical_from_index(geometry, index);
            Proxy proxy;
            proxy.isovalue = test.isovalue;
            if (excess_at(test.field, hip, test.isovalue) < 0.02) continue;
            RecoverPath path;
            update_exact(proxy, test.field, hip, {}, path.observer());
            const double first = path.points.empty() ? 0 : (path.points[0] - hip).norm();
            // Steps longer than a tetrahedron come from the search that follows where descent ends.
            if (first == 0 || first > geometry.spacing.minCoeff()) continue;
            const double from = excess_at(test.field, hip, test.isovalue);
            const double slope =
                (from - excess_at(test.field, path.points[0], test.isovalue)) / first;
            ++compared;
            for (int k = 0; k < 300; ++k) {
                const Vec3 to = hip + 1e-4 * random.direction();
                const double other = (from - excess_at(test.field, to, test.isovalue)) / 1e-4;
                ASSERT_LE(other, slope + 1e-7) << test.name << " seed 59 start " << i;
            }
        }
        EXPECT_GT(compared, scaled(2000) / 10);
    }
}

TEST(Recovery, goes_to_the_nearest_wall_of_a_plateau) {
    const Field field = block_field(24, 4, 19);
    Random random(55);
    for (int i = 0; i < 300; ++i) {
        const Vec3 hip = random.point(5, 18);
        Proxy proxy;
        proxy.isovalue = 127.5;
        const int updates = updates_until_out(proxy, field, hip, 20);
        ASSERT_GT(updates, 0) << hip.transpose();
        ASSERT_LE(excess_at(field, proxy.scp_physical, 127.5), 1e-9);
        const double nearest =
            std::min((hip.array() - 3.5).minCoeff(), (19.5 - hip.array()).minCoeff());
        EXPECT_LE((proxy.scp_physical - hip).norm(), nearest + 0.6) << hip.transpose();
    }
}

TEST(Recovery, ends_within_a_few_updates_from_the_middle_of_a_block_of_two_hundred_voxels) {
    const Field field = block_field(210, 4, 205);
    Proxy proxy;
    proxy.isovalue = 127.5;
    const Vec3 hip(100.3, 110.2, 95.7);
    const int updates = updates_until_out(proxy, field, hip, 200);
    EXPECT_GT(updates, 1);
    EXPECT_LE(updates, 40);
    EXPECT_NEAR((proxy.scp_physical - hip).norm(), 92.2, 0.6);
    EXPECT_LE(excess_at(field, proxy.scp_physical, 127.5), 1e-9);
}

TEST(Recovery, ends_under_small_budgets_too) {
    const Field field = block_field(64, 4, 59);
    for (const int budget : {16, 128, 256, 1024}) {
        ProxySettings settings;
        settings.step_budget = budget;
        Proxy proxy;
        proxy.isovalue = 127.5;
        EXPECT_GT(updates_until_out(proxy, field, Vec3(31.3, 30.2, 32.9), 2000, settings), 0)
            << "budget " << budget;
    }
}

TEST(Recovery, looks_no_farther_than_the_nearest_way_out_and_moves_on_with_the_rest_of_the_budget) {
    for (const Interpolation interpolation : {Interpolation::linear, Interpolation::cubic}) {
        Field field = block_field(40, 4, 35);
        field.set_interpolation(interpolation);
        ProxySettings settings;
        // Looking as far in all directions leaves too little of it.
        settings.step_budget = interpolation == Interpolation::linear ? 460 : 800;
        Proxy proxy;
        proxy.isovalue = 300;  // nothing is solid
        const Vec3 start(26.3, 20.1, 5.0), end(8.3, 20.1, 5.0);
        ASSERT_EQ(update_exact(proxy, field, start).mode, Mode::free);
        proxy.isovalue = 127.5;
        const ProxyUpdate r = update_exact(proxy, field, end, settings);
        EXPECT_EQ(r.status, UpdateStatus::done);
        EXPECT_EQ(r.mode, Mode::constrained);
        EXPECT_NEAR((r.scp - end).norm(), 1.5, 0.01) << "under the hand, on the face";
    }
}

TEST(Recovery, leaves_a_local_minimum) {
    // A pit in a hill that is still solid: descent ends in it, the path out leads over its rim.
    const Field field = linear_field(volume_of<float>(grid(cube(24)), [](const Index3& i) {
        const double r = (i.cast<double>() - Vec3::Constant(11.5)).norm();
        return r < 4 ? 50 + 10 * r : 130 - 10 * r;
    }));
    Random random(56);
    for (int i = 0; i < 200; ++i) {
        Proxy proxy;
        proxy.isovalue = 40;
        const Vec3 hip = Vec3::Constant(11.5) + 2 * random.direction();
        ASSERT_GT(updates_until_out(proxy, field, hip, 20), 0);
        ASSERT_LE(excess_at(field, proxy.scp_physical, 40), 1e-9);
    }
}

TEST(Recovery, in_space_that_is_all_solid_says_so_and_ends_every_update) {
    const Field field =
        linear_field(volume_of<std::uint8_t>(grid(cube(8)), [](const Index3&) { return 200; }),
                     Solid::above, 180.0);
    Hand hand(field.geometry(), 57);
    Proxy proxy;
    proxy.isovalue = 100;
    for (int i = 0; i < 300; ++i) {
        const ProxyUpdate r = update_exact(proxy, field, hand.next());
        ASSERT_EQ(r.status, UpdateStatus::recovering);
        ASSERT_TRUE(r.scp.allFinite());
        ASSERT_LE(r.tetrahedra, 4096);
    }
    Proxy placed;
    EXPECT_FALSE(place(placed, field, Vec3(4, 4, 4), 100));
    // It comes out once there is free space.
    proxy.isovalue = 190;
    EXPECT_GT(updates_until_out(proxy, field, Vec3(4, 4, 4), 20), 0);
}

TEST(Recovery, takes_the_free_hip_where_the_way_out_is_longer) {
    // Solid on x < 12 and all around, saturated: out of it leads a search along the axes.
    const Field field =
        linear_field(volume_of<std::uint8_t>(grid(cube(24)),
                                             [](const Index3& i) { return i[0] < 12 ? 255 : 0; }),
                     Solid::above, 255.0);
    Proxy proxy;
    ASSERT_TRUE(place(proxy, field, Vec3(15, 11, 11), 127.5));
    proxy.scp = locate(Vec3(5, 11, 11));
    proxy.scp_physical = Vec3(5, 11, 11);
    const Vec3 hip(11.6, 11.3, 11);
    const ProxyUpdate r = update_exact(proxy, field, hip);
    EXPECT_EQ(r.status, UpdateStatus::done);
    EXPECT_EQ(r.scp, hip);
}

TEST(Place, is_the_hip_where_that_is_free_and_on_the_surface_or_free_elsewhere) {
    for (const TestField& test : {noise_field(), oblique_field(), terraces_field(), salt_field()}) {
        Random random(58);
        const Field& field = test.field;
        int free = 0;
        int solid = 0;
        for (int i = 0; i < scaled(20000); ++i) {
            const Vec3 size = field.geometry().size.cast<double>();
            const Vec3 index = random.point(-0.1, 1.1).cwiseProduct(size);
            const Vec3 hip = physical_from_index(field.geometry(), index);
            const double excess = excess_at(field, hip, test.isovalue);
            Proxy proxy;
            ASSERT_TRUE(place(proxy, field, hip, test.isovalue));
            ASSERT_TRUE(proxy.placed);
            ASSERT_EQ(proxy.isovalue, test.isovalue);
            const double at = excess_at(field, proxy.scp_physical, test.isovalue);
            ASSERT_LE(at, 1e-9);
            if (excess < -1e-9) {
                ++free;
                ASSERT_EQ(proxy.scp_physical, hip);
                ASSERT_EQ(proxy.mode, Mode::free);
            } else if (excess > 1e-9) {
                ++solid;
                ASSERT_TRUE(proxy.mode == Mode::free || at >= -1e-9);
            }
        }
        EXPECT_GT(free, scaled(20000) / 20);
        EXPECT_GT(solid, scaled(20000) / 20);
    }
}

TEST(Place, refuses_a_hip_that_is_not_finite) {
    const TestField test = noise_field();
    Proxy proxy;
    EXPECT_FALSE(place(proxy, test.field, Vec3(0, std::nan(""), 0), 128));
    EXPECT_FALSE(place(proxy, test.field, Vec3(1e30, 0, 0), 128));
}

TEST(Recovery, never_ends_an_update_deeper_than_it_began) {
    // With a small budget updates end while the smooth field's line search is at any of its trials.
    const Field field = smooth(noise_field().field);
    Random random(8);
    int inside = 0;
    for (int i = 0; i < scaled(20'000); ++i) {
        Proxy proxy;
        proxy.isovalue = 40;
        proxy.placed = true;
        proxy.scp_physical = random.point(2, 21);
        const double before = excess_at(field, proxy.scp_physical, 40);
        if (!(before > 0)) continue;
        ProxySettings settings;
        settings.step_budget = 1 + random.below(30);
        const ProxyUpdate r = update_exact(proxy, field, proxy.scp_physical, settings);
        if (r.status != UpdateStatus::recovering) continue;
        ++inside;
        ASSERT_LE(excess_at(field, r.scp, 40), before + 1e-12);
    }
    EXPECT_GT(inside, scaled(1000));
}
