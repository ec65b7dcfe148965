// The point at which a click meets the surface, and the way there.
#include <gtest/gtest.h>

#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/model/probe_route.hpp"
#include "palpate/scenes/volumes.hpp"

namespace palpate::viewer::test {
namespace {

const Vec3 towards = Vec3::UnitZ(), up = Vec3::UnitY();

TEST(ProbeRoute, a_click_meets_the_surface_nearest_to_the_viewer) {
    const scenes::Scene scene = scenes::make_volume("sphere:48x48x48");
    const Field field = linear_field(scene.volume);
    const Vec3 centre = physical_centre(field.geometry());
    const auto front = surface_under(field, scene.isovalue, centre, towards);
    const auto back = surface_under(field, scene.isovalue, centre, -towards);
    ASSERT_TRUE(front && back);
    EXPECT_GT((*front - centre)[2], 5);
    EXPECT_LT((*back - centre)[2], -5);
    EXPECT_NEAR(((*front + *back) / 2 - centre).norm(), 0, 0.1);
    const Vec3 corner = physical_from_index(field.geometry(), Vec3(1, 1, 20));
    EXPECT_FALSE(surface_under(field, scene.isovalue, corner, towards)) << "beside the ball";
    const auto under = [&](const Vec3& point, const Vec3& normal) {
        const CutPlane cuts[] = {{point, normal}};
        return surface_under(field, scene.isovalue, centre, towards, cuts);
    };
    EXPECT_EQ(under(centre, -towards), front) << "behind it all is cut away";
    EXPECT_FALSE(under(centre, towards)) << "the cut goes through the solid";
    EXPECT_FALSE(under(*front + 5 * towards, -towards)) << "all that lies there is cut away";
    const Vec3 aside = towards.unitOrthogonal();
    EXPECT_EQ(under(centre - aside, -aside), front);
    EXPECT_FALSE(under(centre + aside, -aside));
    EXPECT_EQ(surface_in_view(field, scene.isovalue, towards, up), front);
}

TEST(ProbeRoute, beside_the_middle_the_nearest_surface_in_view_is_taken) {
    const scenes::Scene scene = scenes::make_volume("torus:48x48x24");
    const Field field = linear_field(scene.volume);
    const Vec3 centre = physical_centre(field.geometry());
    ASSERT_FALSE(surface_under(field, scene.isovalue, centre, towards)) << "the hole";
    const auto found = surface_in_view(field, scene.isovalue, towards, up);
    ASSERT_TRUE(found);
    EXPECT_GT((*found - centre)[2], 0);
    EXPECT_FALSE(surface_in_view(field, 1e9, towards, up)) << "nothing is solid";
}

TEST(ProbeRoute, a_tool_that_comes_from_in_front_rests_with_the_point_that_touches_first) {
    const scenes::Scene scene = scenes::make_volume("sphere:48x48x48");
    const Field field = linear_field(scene.volume);
    const Vec3 at = physical_centre(field.geometry()) + Vec3(6, 0, 0);
    const Vec3 bare = tool_on_surface(field, scene.isovalue, at, towards, {}).value();
    EXPECT_EQ(bare, surface_under(field, scene.isovalue, at, towards));
    const std::vector<Vec3> points{{0, 0, -3}, {-6, 0, 0}, {0, 0, 5}};
    const Vec3 rest = tool_on_surface(field, scene.isovalue, at, towards, points).value();
    EXPECT_EQ(rest.head<2>(), bare.head<2>());
    double most = bare[2];
    for (const Vec3& point : points) {
        const auto met = surface_under(field, scene.isovalue, at + point, towards);
        most = std::max(most, met.value()[2] - point[2]);
    }
    EXPECT_NEAR(rest[2], most, 1e-9);
    EXPECT_GT(rest[2], bare[2] + 2);
    const Vec3 beside = physical_from_index(field.geometry(), Vec3(1, 1, 20));
    EXPECT_FALSE(tool_on_surface(field, scene.isovalue, beside, towards, points));
}

TEST(ProbeRoute, a_single_slice_has_a_front) {
    const Geometry geometry{Index3(9, 9, 1)};
    const Field field =
        linear_field(Volume(geometry, std::vector<std::uint8_t>(81, 200)), Solid::above, 0.0);
    const auto surface = surface_in_view(field, 100, towards, up);
    ASSERT_TRUE(surface);
    EXPECT_GT((*surface)[2], 0);
    EXPECT_LT((*surface)[2], 1);
}

TEST(ProbeRoute, the_way_goes_round_the_grid_in_front) {
    Geometry geometry{Index3(11, 11, 11)};
    const Vec3 from(3, 4, 5), to(8, 1, 9);
    const std::vector<Vec3> stops = route_in_front(geometry, from, to, towards, towards);
    ASSERT_EQ(stops.size(), 3U);
    const double front = extent_along(geometry, towards).front;
    EXPECT_EQ(stops[0].head<2>(), from.head<2>());
    EXPECT_EQ(stops[1].head<2>(), to.head<2>());
    EXPECT_GT(stops[0][2], front);
    EXPECT_EQ(stops[1][2], stops[0][2]);
    EXPECT_EQ(stops[2], to);
    // A hand that is farther out already does not come nearer on its way across.
    const Vec3 far(3, 4, 50);
    EXPECT_EQ(route_in_front(geometry, far, to, towards, towards)[1][2], 50);
}

TEST(ProbeRoute, the_way_from_one_side_to_any_other_stays_outside_of_the_grid) {
    Geometry geometry{Index3(11, 11, 11)};
    const Vec3 from(3, 4, 5), to(8, 1, 9);
    for (const Vec3& leaving : {Vec3(0, 0, 1), Vec3(1, 2, -2), Vec3(-1, 0, 0.1)}) {
        for (const Vec3& arriving :
             {Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(-1, -2, 2), Vec3(2, 1, 0)}) {
            const auto stops =
                route_in_front(geometry, from, to, leaving.normalized(), arriving.normalized());
            for (std::size_t i = 1; i + 1 < stops.size(); ++i) {
                for (int part = 0; part <= 100; ++part) {
                    const Vec3 at = stops[i - 1] + 0.01 * part * (stops[i] - stops[i - 1]);
                    EXPECT_FALSE(((at.array() >= 0) && (at.array() <= 10)).all())
                        << leaving.transpose() << " to " << arriving.transpose();
                }
            }
            EXPECT_EQ(stops.back(), to);
        }
    }
}

TEST(ProbeRoute, a_point_of_a_slice_is_reached_from_where_least_is_in_the_way) {
    const scenes::Scene scene = scenes::make_volume("sphere:48x48x48");
    const Field field = linear_field(scene.volume);
    const Vec3 centre = physical_centre(field.geometry());
    const auto to = [&](const Vec3& point, std::span<const Vec3> tool = {}) {
        return approach_to(field, scene.isovalue, point, towards, tool).value();
    };
    const double radius = (*surface_under(field, scene.isovalue, centre, towards) - centre).norm();
    const Approach beside = to(centre + Vec3(radius + 3, 0, 0));
    EXPECT_EQ(beside.towards, towards);
    EXPECT_FALSE(beside.surface);
    // At the back, where the viewer does not see the surface.
    const Vec3 behind = centre + (radius - 2) * Vec3(0.6, 0, -0.8);
    const Approach back = to(behind);
    EXPECT_LT((back.towards - Vec3(0.6, 0, -0.8)).norm(), 0.1) << back.towards.transpose();
    EXPECT_NEAR((back.surface.value() - behind).norm(), 2, 0.3);
    EXPECT_GT(to(behind, std::vector<Vec3>{{0, 0, 2}, {0, 0, -2}}).surface.value().norm(),
              back.surface.value().norm() + 1)
        << "the tool touches before its middle does";
    EXPECT_TRUE(to(centre).surface);
    EXPECT_FALSE(approach_to(field, -1, centre, towards, {})) << "all is solid";
}

}  // namespace
}  // namespace palpate::viewer::test
