// Camera navigation.
#include "apps/viewer/scene/navigation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/fields.hpp"
#include "support/random.hpp"

namespace palpate::viewer {
namespace {

using support::Random;

constexpr ViewSize size{400, 300};

Camera random_camera(Random& random) {
    const Vec3 towards = random.direction();
    return {random.point(-50, 50), towards, towards.cross(random.direction()),
            random.uniform(1, 100)};
}

TEST(Navigation, point_at_a_pixel_is_seen_at_that_pixel) {
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        const Camera camera = random_camera(random);
        const Pixel pixel{random.uniform(0, 400), random.uniform(0, 300)};
        const Vec3 point = point_at(camera, size, pixel);
        const Vec3 behind = point - random.uniform(0, 30) * axes_of(camera).towards_viewer;
        for (const Vec3& p : {point, behind}) {
            EXPECT_NEAR(pixel_of(camera, size, p).x, pixel.x, 1e-9);
            EXPECT_NEAR(pixel_of(camera, size, p).y, pixel.y, 1e-9);
        }
    }
}

TEST(Navigation, front_view_has_the_body_left_on_the_right_and_its_top_above) {
    const Camera camera;  // from the front
    EXPECT_GT(pixel_of(camera, size, Vec3(0.5, 0, 0)).x, 200);
    EXPECT_LT(pixel_of(camera, size, Vec3(0, 0, 0.5)).y, 150);
}

TEST(Navigation, panning_keeps_what_is_under_the_pointer_there) {
    Random random(2);
    for (int i = 0; i < 50; ++i) {
        const Camera camera = random_camera(random);
        const Vec3 point = point_at(camera, size, {100, 80});
        const Pixel seen = pixel_of(panned(camera, size, 31, -17), size, point);
        EXPECT_NEAR(seen.x, 131, 1e-9);
        EXPECT_NEAR(seen.y, 63, 1e-9);
    }
}

TEST(Navigation, zooming_keeps_what_is_under_the_pointer_there) {
    Random random(3);
    for (int i = 0; i < 50; ++i) {
        const Camera camera = random_camera(random);
        const Vec3 point = point_at(camera, size, {330, 20});
        const Camera nearer = zoomed(camera, size, 1.7, {330, 20});
        EXPECT_NEAR(nearer.half_height, camera.half_height / 1.7, 1e-9);
        EXPECT_NEAR(pixel_of(nearer, size, point).x, 330, 1e-8);
        EXPECT_NEAR(pixel_of(nearer, size, point).y, 20, 1e-8);
    }
}

TEST(Navigation, zoom_has_an_end_in_both_directions) {
    Camera camera;
    for (int i = 0; i < 100; ++i) camera = zoomed(camera, size, 10, {200, 150});
    EXPECT_GT(camera.half_height, 0);
    for (int i = 0; i < 100; ++i) camera = zoomed(camera, size, 0.1, {200, 150});
    EXPECT_TRUE(std::isfinite(camera.half_height));
    EXPECT_TRUE(camera.focus.allFinite());
}

TEST(Navigation, what_faces_the_viewer_follows_the_pointer_when_turned) {
    Random random(4);
    for (int i = 0; i < 50; ++i) {
        const Camera camera = random_camera(random);
        const Vec3 front = camera.focus + 0.3 * camera.half_height * axes_of(camera).towards_viewer;
        const Pixel before = pixel_of(camera, size, front);
        const Pixel right = pixel_of(turned(camera, size, 5, 0), size, front);
        const Pixel down = pixel_of(turned(camera, size, 0, 5), size, front);
        EXPECT_GT(right.x, before.x + 0.5);
        EXPECT_NEAR(right.y, before.y, 1e-6);
        EXPECT_GT(down.y, before.y + 0.5);
        EXPECT_NEAR(down.x, before.x, 1e-6);
    }
}

TEST(Navigation, a_thousand_turns_leave_a_camera_that_can_be_looked_through) {
    Random random(5);
    Camera camera = random_camera(random);
    const Vec3 focus = camera.focus;
    for (int i = 0; i < 1000; ++i) {
        camera = turned(camera, size, random.uniform(-90, 90), random.uniform(-90, 90));
    }
    EXPECT_NEAR(camera.towards_viewer.norm(), 1, 1e-9);
    EXPECT_NEAR(camera.up.dot(camera.towards_viewer), 0, 1e-9);
    EXPECT_EQ(camera.focus, focus);
}

TEST(Navigation, the_whole_grid_is_inside_the_picture_and_fills_it) {
    Random random(6);
    Mat3 mirrored = support::oblique_direction();
    mirrored.col(0) *= -1;
    for (int i = 0; i < 50; ++i) {
        const Geometry geometry =
            support::grid(Index3(2 + random.below(90), 2 + random.below(90), 2 + random.below(90)),
                          Vec3(0.5, 1, 2.5), random.point(-500, 500), mirrored);
        const Camera towards = random_camera(random);
        const Camera camera = whole(geometry, {towards.towards_viewer, towards.up}, size);
        double widest = 0, highest = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 index(corner & 1 ? geometry.size[0] - 1 : 0,
                             corner & 2 ? geometry.size[1] - 1 : 0,
                             corner & 4 ? geometry.size[2] - 1 : 0);
            const Pixel seen = pixel_of(camera, size, physical_from_index(geometry, index));
            widest = std::max(widest, std::abs(seen.x - 200) / 200);
            highest = std::max(highest, std::abs(seen.y - 150) / 150);
        }
        EXPECT_LT(std::max(widest, highest), 1);
        EXPECT_GT(std::max(widest, highest), 0.9);
    }
}

}  // namespace
}  // namespace palpate::viewer
