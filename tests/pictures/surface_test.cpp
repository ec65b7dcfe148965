// Surfaces for pictures, and camera views.
#include "pictures/surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "palpate/lattice.hpp"
#include "palpate/scenes/volumes.hpp"
#include "pictures/levels.hpp"
#include "pictures/view.hpp"

namespace palpate::pictures {
namespace {

TEST(PictureSurface, is_the_mesh_that_the_proxy_meets) {
    const scenes::Scene scene = scenes::make_volume("noise:9x8x7");
    const Field field = linear_field(scene.volume);
    const ShadedSurface made = shaded_surface(field, scene.isovalue);
    const SurfaceMesh mesh = extract_surface(field, scene.isovalue);
    EXPECT_EQ(made.every, 1);
    EXPECT_EQ(made.surface.mesh.vertices, mesh.vertices);
    EXPECT_EQ(made.surface.mesh.triangles, mesh.triangles);
    ASSERT_EQ(made.surface.normals.size(), mesh.vertices.size());
}

TEST(PictureSurface, of_every_third_sample_is_the_surface_of_those) {
    const scenes::Scene scene = scenes::make_volume("noise:10x8x7");
    const Geometry& all = scene.volume.geometry();
    Geometry geometry = all;
    geometry.size = Index3(4, 3, 3);
    geometry.spacing *= 3;
    std::vector<float> samples;
    for (int z = 0; z < 7; z += 3) {
        for (int y = 0; y < 8; y += 3) {
            for (int x = 0; x < 10; x += 3) {
                samples.push_back(static_cast<float>(scene.volume.sample(Index3(x, y, z))));
            }
        }
    }
    const Field field = linear_field(scene.volume);
    SurfaceWork work;
    work.every = 3;
    const ShadedSurface made = shaded_surface(field, scene.isovalue, work);
    const Field thinned =
        linear_field(Volume(geometry, samples), field.solid(), field.background());
    EXPECT_EQ(made.every, 3);
    EXPECT_FALSE(made.surface.mesh.vertices.empty());
    EXPECT_EQ(made.surface.mesh.vertices, extract_surface(thinned, scene.isovalue).vertices);
    work.every = 0;
    EXPECT_THROW(shaded_surface(field, scene.isovalue, work), std::invalid_argument);
}

TEST(PictureSurface, normals_of_a_ball_point_out_of_the_solid) {
    for (const Solid solid : {Solid::above, Solid::below}) {
        Geometry geometry = scenes::centred(Index3(24, 20, 16), Vec3(1, 1.2, 1.5));
        const scenes::Scene scene = scenes::make_volume("sphere", geometry, SampleType::float32);
        const Field field = linear_field(scene.volume, solid, scene.volume.minimum());
        const ShadedSurface made = shaded_surface(field, scene.isovalue);
        const double sign = solid == Solid::above ? 1 : -1;
        ASSERT_GT(made.surface.normals.size(), 500U);
        double worst = 0;
        for (std::size_t i = 0; i < made.surface.normals.size(); ++i) {
            const Vec3 normal = made.surface.normals[i].cast<double>();
            EXPECT_NEAR(normal.norm(), 1, 1e-5);
            const Vec3 outward = sign * made.surface.mesh.vertices[i].normalized();
            worst = std::max(worst, std::acos(std::min(1.0, normal.dot(outward))));
        }
        EXPECT_LT(worst * 180 / std::numbers::pi, 8);
    }
}

TEST(PictureSurface, is_never_shaded_from_behind) {
    // Noise: the differences over a voxel often say nothing about a facet.
    const scenes::Scene scene = scenes::make_volume("noise:12x12x12");
    const ShadedSurface made = shaded_surface(linear_field(scene.volume), scene.isovalue);
    const auto facets = mesh_normals(made.surface.mesh);
    int replaced = 0;
    for (std::size_t i = 0; i < facets.size(); ++i) {
        EXPECT_TRUE(made.surface.normals[i].allFinite());
        EXPECT_GT(made.surface.normals[i].dot(facets[i]), 0.29F);
        replaced += made.surface.normals[i] == facets[i];
    }
    EXPECT_GT(replaced, 10);
    EXPECT_LT(replaced, int(facets.size()) / 2);
}

TEST(PictureSurface, one_that_is_too_large_is_made_from_fewer_samples) {
    const scenes::Scene scene = scenes::make_volume("sphere:41x41x41");
    const Field field = linear_field(scene.volume);
    SurfaceWork work;
    work.most_triangles = extract_surface(field, scene.isovalue).triangles.size() / 2;
    const ShadedSurface made = shaded_surface(field, scene.isovalue, work);
    EXPECT_GE(made.every, 2);
    EXPECT_LE(made.surface.mesh.triangles.size(), work.most_triangles);
    const double whole = enclosed_volume(extract_surface(field, scene.isovalue));
    EXPECT_NEAR(enclosed_volume(made.surface.mesh), whole, 0.1 * whole);
}

TEST(PictureSurface, progress_rises_and_may_throw) {
    const scenes::Scene scene = scenes::make_volume("sphere:20x20x20");
    double last = 0;
    SurfaceWork work;
    work.progress = [&](double fraction) {
        EXPECT_GE(fraction, last);
        last = fraction;
    };
    (void)shaded_surface(linear_field(scene.volume), scene.isovalue, work);
    EXPECT_EQ(last, 1);
    struct Stop {};
    work.progress = [](double) { throw Stop(); };
    EXPECT_THROW((void)shaded_surface(linear_field(scene.volume), scene.isovalue, work), Stop);
}

TEST(PictureLevels, are_ordered_from_the_outside_in) {
    const scenes::Scene scene = scenes::make_volume("sphere:16x16x16");
    for (const Solid solid : {Solid::above, Solid::below}) {
        PictureScene picture;
        add_levels(picture, linear_field(scene.volume, solid), std::array{120.0, 40.0, 200.0});
        ASSERT_EQ(picture.surfaces.size(), 3U);
        const bool above = solid == Solid::above;
        EXPECT_EQ(picture.surfaces[0].label, above ? "isovalue 40" : "isovalue 200");
        EXPECT_EQ(picture.surfaces[2].label, above ? "isovalue 200" : "isovalue 40");
        EXPECT_LT(picture.surfaces[0].opacity, 1);
        EXPECT_EQ(picture.surfaces[2].opacity, 1);
    }
    PictureScene picture;
    EXPECT_THROW(add_levels(picture, linear_field(scene.volume), std::vector<double>(6, 1.0)),
                 std::invalid_argument);
}

TEST(PicturePath, of_the_proxy_is_drawn_in_contact_only) {
    PictureScene scene;
    const std::vector<Vec3> hip{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
    add_path(scene, hip, hip, {true, true, false, true, true});
    ASSERT_EQ(scene.lines.size(), 3U);
    EXPECT_EQ(scene.lines[0].points.size(), 5U);
    EXPECT_EQ(scene.lines[1].points.back(), Vec3(1, 0, 0));
    EXPECT_EQ(scene.lines[2].points.front(), Vec3(3, 0, 0));
    EXPECT_EQ(scene.lines[2].label, "");  // in the legend once
}

TEST(View, sides_are_the_bodys) {
    EXPECT_EQ(view_named("front").towards_viewer, Vec3(0, -1, 0));
    EXPECT_EQ(view_named("left").towards_viewer, Vec3(1, 0, 0));
    EXPECT_EQ(view_named("top").up, Vec3(0, -1, 0));
    EXPECT_THROW((void)view_named("sideways"), std::invalid_argument);
    for (const std::string& name : view_names()) {
        const View view = view_named(name);
        EXPECT_GT(view.towards_viewer.cross(view.up).norm(), 0.5) << name;
    }
}

TEST(View, azimuth_and_elevation_agree_with_the_names) {
    const auto same = [](const View& view, const std::string& name) {
        EXPECT_LT((view.towards_viewer - view_named(name).towards_viewer).norm(), 1e-12) << name;
        EXPECT_LT((view.up - view_named(name).up).norm(), 1e-12) << name;
    };
    same(view_from(0, 0), "front");
    same(view_from(90, 0), "left");
    same(view_from(-90, 0), "right");
    same(view_from(180, 0), "back");
    EXPECT_LT((view_from(0, 90).towards_viewer - Vec3(0, 0, 1)).norm(), 1e-12);
    EXPECT_THROW((void)view_from(0, 91), std::invalid_argument);
    EXPECT_THROW((void)view_from(std::nan(""), 0), std::invalid_argument);
}

TEST(View, rolling_clockwise_brings_what_was_left_to_the_top) {
    // From the front the body's right side is at our left; clockwise by 90 degrees it is on top.
    const View view = rolled(view_named("front"), 90);
    EXPECT_LT((view.up - Vec3(-1, 0, 0)).norm(), 1e-12);
}

TEST(View, a_slab_is_seen_on_its_broad_side_and_a_contact_from_its_own) {
    Geometry slab = scenes::centred(Index3(100, 20, 90));
    EXPECT_GT(std::abs(natural_view(slab, Vec3::Zero()).towards_viewer.normalized()[1]), 0.8);
    EXPECT_LT(natural_view(slab, Vec3(0, -5, 0)).towards_viewer[1], 0);
    EXPECT_GT(natural_view(slab, Vec3(0, 5, 0)).towards_viewer[1], 0);
    const Geometry cube = scenes::centred(Index3(50, 50, 50));
    for (const Vec3& towards :
         {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(-0.5, 1, -0.4)}) {
        const View view = natural_view(cube, 30 * towards);
        EXPECT_GT(view.towards_viewer.normalized().dot(towards.normalized()), 0.5);
        EXPECT_GT(view.towards_viewer.normalized().cross(view.up).norm(), 0.05);
    }
}

TEST(View, framing_shows_all_of_a_body_and_zooms_about_a_point) {
    const scenes::Scene ball = scenes::make_volume("sphere:20x20x20");
    PictureScene scene;
    add_levels(scene, linear_field(ball.volume), std::array{ball.isovalue});
    frame(scene, view_from(30, 20));
    const Camera whole = scene.camera;
    const Vec3 right = whole.up.cross(whole.towards_viewer);
    for (const Vec3& v : scene.surfaces[0].mesh.vertices) {
        const Vec3 at = v - whole.focus;
        EXPECT_LT(std::abs(at.dot(whole.up)), whole.half_height / 1.1);
        EXPECT_LT(std::abs(at.dot(right)), whole.half_height * scene.width / scene.height / 1.1);
    }
    const Vec3 corner = whole.focus + Vec3(3, 4, 5);
    frame(scene, view_from(30, 20), 1e6, corner);
    EXPECT_LT((scene.camera.focus - corner).norm(), 1e-4);
    EXPECT_NEAR(scene.camera.half_height, whole.half_height / 1e6, 1e-9);
}

}  // namespace
}  // namespace palpate::pictures
