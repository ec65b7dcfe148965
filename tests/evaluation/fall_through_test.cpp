// fall-through in its quick mode; closed walls, and the search for what can be reached from
// outside.
#include <gtest/gtest.h>

#include "evaluation/claims.hpp"
#include "evaluation/fall_through/crossing.hpp"
#include "evaluation/fall_through/shell.hpp"
#include "palpate/baselines/methods.hpp"
#include "palpate/scenes/volumes.hpp"
#include "palpate/surface.hpp"
#include "support/mesh_checks.hpp"
#include "support/random.hpp"

namespace palpate::evaluation {
namespace {

constexpr Interpolation linear = Interpolation::linear, cubic = Interpolation::cubic;

Outside outside_of(const Subject& subject) {
    return {subject.field, subject.isovalue, [] {}};
}

constexpr double thicknesses[] = {3, 2, 1.5, 1, 0.75, 0.5, 0.25};

TEST(FallThrough, claims_hold_in_quick_mode) {
    const Result result = quick_result(fall_through);
    EXPECT_EQ(result.claims.size(), 9U);
}

TEST(FallThrough, the_same_seed_gives_the_same_table_and_another_one_another) {
    Options options = quick_options();
    options.subjects.push_back(closed_shell(Enclosed::ball, 0.5, linear));
    const std::string first = csv_from(fall_through(options).table);
    EXPECT_EQ(first, csv_from(fall_through(options).table));
    options.seed = 2;
    EXPECT_NE(first, csv_from(fall_through(options).table));
}

TEST(FallThrough, no_exact_proxy_ends_inside_a_thick_body_of_the_user) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("sphere:40x40x40"));
    const Result result = fall_through(options);
    EXPECT_EQ(result.claims.size(), 4U);
    EXPECT_TRUE(all_hold(result));
}

TEST(FallThrough, a_volume_in_which_nothing_is_closed_is_refused) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("sphere:16x16x16", 300));  // above all of the data
    EXPECT_THROW(fall_through(options), std::invalid_argument);
    options.subjects = {synthetic("sphere:16x16x16", -1)};  // the background is solid
    EXPECT_THROW(fall_through(options), std::invalid_argument);
}

/// The surface's inner and outer sheet: vertices nearer to the centre than the wall's middle, and
/// the others, share no triangle, and each sheet winds round the cavity once.
TEST(FallThrough, walls_are_closed_by_the_surface_and_by_the_flood) {
    for (const auto& [enclosed, interpolation] :
         {std::pair{Enclosed::box, linear}, std::pair{Enclosed::ball, linear},
          std::pair{Enclosed::box, cubic}, std::pair{Enclosed::ball, cubic}}) {
        for (const double thickness : {3.0, 1.0, 0.25}) {
            const Subject wall = closed_shell(enclosed, thickness, interpolation);
            const SurfaceMesh mesh = extract_surface(wall.field, wall.isovalue);
            EXPECT_EQ(support::flaw_in_closed_mesh(mesh), "");
            const Outside outside = outside_of(wall);
            SurfaceMesh outer = mesh, inner = mesh;
            outer.triangles.clear();
            inner.triangles.clear();
            for (const auto& triangle : mesh.triangles) {
                int reached = 0;
                for (const std::uint32_t v : triangle) {
                    reached += outside.holds(mesh.vertices[v]);
                }
                ASSERT_TRUE(reached == 0 || reached == 3) << wall.name << ' ' << thickness;
                (reached ? outer : inner).triangles.push_back(triangle);
            }
            EXPECT_EQ(support::flaw_in_closed_mesh(outer), "");
            EXPECT_EQ(support::flaw_in_closed_mesh(inner), "");
            const Vec3 centre(0.01, 0.02, -0.03), ray(0.3, 0.5, 0.81);
            EXPECT_EQ(support::winding(outer, centre, ray), 1) << wall.name << ' ' << thickness;
            EXPECT_EQ(support::winding(inner, centre, ray), -1) << wall.name << ' ' << thickness;
        }
    }
}

TEST(FallThrough, walls_have_the_thickness_that_is_asked_for) {
    for (int i = 0; i < 14; ++i) {
        const double thickness = thicknesses[i % 7];
        const Subject wall = closed_shell(Enclosed::box, thickness, i < 7 ? linear : cubic);
        const Field inverse(wall.field.volume(), Solid::below, wall.field.background(),
                            wall.field.interpolation());
        support::Random random(7);
        for (int line = 0; line < 50; ++line) {
            const Vec3 from(-20, random.uniform(-5, 5), random.uniform(-5, 5));
            const Vec3 to(0, from[1], from[2]);
            const RayHit in = cast_ray(wall.field, wall.isovalue, from, to);
            ASSERT_TRUE(in.hit);
            const Vec3 start = in.point + Vec3(1e-9, 0, 0);
            const RayHit out = cast_ray(inverse, wall.isovalue, start, to);
            ASSERT_TRUE(out.hit);
            EXPECT_NEAR(out.point[0] - in.point[0], thickness, 1e-8);
        }
    }
    EXPECT_THROW(closed_shell(Enclosed::box, 0, linear), std::invalid_argument);
    EXPECT_THROW(closed_shell(Enclosed::box, 4.5, linear), std::invalid_argument);
}

TEST(FallThrough, no_exact_proxy_on_a_random_trajectory_leaves_what_the_flood_has_reached) {
    const Field field(
        scenes::noise(scenes::centred(Index3::Constant(16)), SampleType::uint8, 5, 255));
    const double isovalue = 65;  // near the level at which the free space falls apart
    const Outside outside(field, isovalue, [] {});
    support::Random random(3);
    int unreached = 0, constrained = 0;
    for (int run = 0; run < 20; ++run) {
        Proxy proxy;
        ASSERT_TRUE(place(proxy, field, Vec3(-20, 0, 0), isovalue));
        for (int i = 0; i < 200; ++i) {
            Vec3 hip;
            for (int a = 0; a < 3; ++a) hip[a] = random.uniform(-9, 9);
            constrained += update_exact(proxy, field, hip).mode == Mode::constrained;
            ASSERT_TRUE(outside.holds(proxy.scp));
            const LatticePoint at = locate(index_from_physical(field.geometry(), hip));
            unreached += value_at(field, at) <= isovalue && !outside.holds(at);
        }
    }
    EXPECT_GT(constrained, 1000);
    EXPECT_GT(unreached, 20);  // there is free space that the flood has rightly left out
}

TEST(FallThrough, a_hole_in_a_wall_is_found_by_the_flood_and_by_a_proxy_that_is_led_there) {
    const Subject closed = closed_shell(Enclosed::box, 0.5, linear);
    const Geometry& geometry = closed.field.geometry();
    const auto samples = closed.field.volume().samples<std::uint8_t>();
    std::vector<std::uint8_t> with_hole(samples.begin(), samples.end());
    // The middle sample of the face at low x, 11 voxels from the centre's 13.5.
    Index3 hole(0, 13, 13);
    while (closed.field.volume().sample(hole) == 0) ++hole[0];
    with_hole[std::size_t(hole[0] + 28 * (hole[1] + 28 * hole[2]))] = 0;
    const Field open(Volume(geometry, with_hole));
    const LatticePoint centre = locate(index_from_physical(geometry, Vec3(0, 0, 0)));
    EXPECT_FALSE(outside_of(closed).holds(centre));
    EXPECT_TRUE(Outside(open, closed.isovalue, [] {}).holds(centre));
    Proxy proxy;
    ASSERT_TRUE(
        place(proxy, open, physical_from_index(geometry, Vec3(-2, 13, 13)), closed.isovalue));
    const Vec3 within = physical_from_index(geometry, Vec3(13, 13, 13));
    EXPECT_EQ(update_exact(proxy, open, within).scp, within);
}

TEST(FallThrough, every_line_leads_from_free_space_into_what_cannot_be_reached) {
    const Subject wall = closed_shell(Enclosed::ball, 0.75, linear);
    const Outside outside = outside_of(wall);
    const Geometry& geometry = wall.field.geometry();
    for (const Crossing& crossing : draw_crossings(wall, outside, Target::behind_walls, 300, 1)) {
        const auto at = [&](double s) {
            return locate(index_from_physical(geometry, crossing.entry + s * crossing.along));
        };
        EXPECT_TRUE(outside.holds(at(-1e-3)));
        EXPECT_LE(value_at(wall.field, at(-1e-3)), wall.isovalue);
        EXPECT_GT(value_at(wall.field, at(0.5 * crossing.wall)), wall.isovalue);
        EXPECT_LE(value_at(wall.field, at(crossing.end)), wall.isovalue);
        EXPECT_FALSE(outside.holds(at(crossing.end)));
        EXPECT_GT(crossing.end, crossing.wall);
    }
}

}  // namespace
}  // namespace palpate::evaluation
