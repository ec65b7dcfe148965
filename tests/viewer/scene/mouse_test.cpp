// Camera navigation, and mouse input of the 3-D view by real events.
#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <QWheelEvent>

#include "apps/viewer/scene/navigation.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/fields.hpp"
#include "support/random.hpp"
#include "viewer/scene/shown_scene.hpp"

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

/// Two samples outside the grid lies the box round a body that its border cuts.
TEST(Navigation, the_box_round_the_grid_is_inside_the_picture_and_fills_it) {
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
            const Vec3 index(corner & 1 ? geometry.size[0] + 1 : -2,
                             corner & 2 ? geometry.size[1] + 1 : -2,
                             corner & 4 ? geometry.size[2] + 1 : -2);
            const Pixel seen = pixel_of(camera, size, physical_from_index(geometry, index));
            widest = std::max(widest, std::abs(seen.x - 200) / 200);
            highest = std::max(highest, std::abs(seen.y - 150) / 150);
        }
        EXPECT_LT(std::max(widest, highest), 1);
        EXPECT_GT(std::max(widest, highest), 0.9);
    }
}

struct Hands : ShownScene {
    Vec3 dragged = Vec3::Zero();

    Hands() {
        scene.set_field(linear_field(scenes::ball(support::cube(32))), 128);
        // The middle of the grid is the origin; 0.2 mm a pixel.
        scene.set_camera({Vec3::Zero(), Vec3(0, -1, 0), Vec3(0, 0, 1), 32});
        QObject::connect(&scene, &Scene::probe_dragged, [this](const Vec3& by) { dragged += by; });
    }
    void drag(Qt::MouseButton button, const QPoint& from, const QPoint& to,
              Qt::KeyboardModifiers keys = Qt::NoModifier) {
        QTest::mousePress(&scene, button, keys, from);
        for (int i = 1; i <= 4; ++i) {
            const QPoint at = from + (to - from) * i / 4;
            QMouseEvent move(QEvent::MouseMove, at, scene.mapToGlobal(at), Qt::NoButton, button,
                             keys);
            QCoreApplication::sendEvent(&scene, &move);
        }
        QTest::mouseRelease(&scene, button, keys, to);
    }
    void wheel(const QPoint& at, int notches, Qt::KeyboardModifiers keys = Qt::NoModifier) {
        QWheelEvent event(at, scene.mapToGlobal(at), QPoint(), QPoint(0, 120 * notches),
                          Qt::NoButton, keys, Qt::NoScrollPhase, false);
        QCoreApplication::sendEvent(&scene, &event);
    }
};

TEST(SceneMouse, left_drag_turns_the_camera_about_its_focus) {
    Hands hands;
    const Camera before = hands.scene.camera();
    hands.drag(Qt::LeftButton, {200, 160}, {280, 160});
    const Camera after = hands.scene.camera();
    EXPECT_EQ(after.focus, before.focus);
    EXPECT_EQ(after.half_height, before.half_height);
    // 80 pixels of 320: 45 degrees; the body's right side comes round to the viewer.
    EXPECT_NEAR(after.towards_viewer.dot(before.towards_viewer), std::sqrt(0.5), 1e-6);
    EXPECT_LT(after.towards_viewer[0], -0.5);
    EXPECT_EQ(hands.dragged, Vec3::Zero());
    // And no more once the button is up.
    QTest::mouseMove(&hands.scene, {100, 100});
    EXPECT_EQ(hands.scene.camera().towards_viewer, after.towards_viewer);
}

TEST(SceneMouse, middle_drag_and_shift_with_left_pan) {
    for (const bool middle : {true, false}) {
        Hands hands;
        const Camera before = hands.scene.camera();
        hands.drag(middle ? Qt::MiddleButton : Qt::LeftButton, {200, 160}, {250, 130},
                   middle ? Qt::NoModifier : Qt::ShiftModifier);
        const Camera after = hands.scene.camera();
        EXPECT_EQ(after.towards_viewer, before.towards_viewer);
        EXPECT_LT((after.focus - before.focus - Vec3(-10, 0, -6)).norm(), 1e-9);
    }
}

TEST(SceneMouse, wheel_zooms_about_the_pointer_and_right_drag_about_where_it_began) {
    Hands hands;
    const auto seen = [&](const QPoint& at) {
        return point_at(hands.scene.camera(), {400, 320}, {double(at.x()), double(at.y())});
    };
    const Vec3 point = seen({300, 60});
    hands.wheel({300, 60}, 3);
    EXPECT_LT(hands.scene.camera().half_height, 25);
    EXPECT_LT((seen({300, 60}) - point).norm(), 1e-9);
    hands.wheel({300, 60}, -3);
    EXPECT_NEAR(hands.scene.camera().half_height, 32, 1e-9);
    hands.drag(Qt::RightButton, {300, 60}, {300, 20});
    EXPECT_LT(hands.scene.camera().half_height, 31);
    EXPECT_LT((seen({300, 60}) - point).norm(), 1e-9);
}

TEST(DrawnMouse, shift_and_double_click_recentre_on_the_surface_and_beside_it_does_nothing) {
    Hands hands;
    hands.settled();
    const Vec3 before = hands.scene.camera().focus;
    QTest::mouseDClick(&hands.scene, Qt::LeftButton, Qt::ShiftModifier, {10, 10});
    EXPECT_EQ(hands.scene.camera().focus, before);
    QTest::mouseDClick(&hands.scene, Qt::LeftButton, Qt::ShiftModifier, {225, 160});
    const Vec3 focus = hands.scene.camera().focus;
    EXPECT_NEAR(focus.norm(), 0.35 * 32, 0.4);  // on the ball, where it was clicked
    EXPECT_NEAR(focus[0], 25.5 * 0.2, 0.15);
    EXPECT_LT(focus[1], -5);
}

TEST(SceneMouse, left_drag_moves_the_probe_as_far_as_the_pointer) {
    Hands hands;
    set(hands.scene, &Shown::probe, true);
    const Camera before = hands.scene.camera();
    hands.drag(Qt::LeftButton, {200, 160}, {240, 150});
    EXPECT_LT((hands.dragged - Vec3(8, 0, 2)).norm(), 1e-9);
    hands.dragged = Vec3::Zero();
    hands.drag(Qt::LeftButton, {200, 160}, {240, 150}, Qt::ShiftModifier);
    EXPECT_LT((hands.dragged - 0.2 * Vec3(8, 0, 2)).norm(), 1e-9);
    EXPECT_EQ(hands.scene.camera(), before);
}

TEST(SceneMouse, wheel_forward_moves_the_probe_into_the_screen) {
    Hands hands;
    set(hands.scene, &Shown::probe, true);
    const Camera before = hands.scene.camera();
    hands.wheel({200, 160}, 2);
    EXPECT_LT((hands.dragged - Vec3(0, 6, 0)).norm(), 1e-9);  // 15 pixels a notch
    hands.dragged = Vec3::Zero();
    hands.wheel({200, 160}, -1, Qt::ShiftModifier);
    EXPECT_LT((hands.dragged - Vec3(0, -0.6, 0)).norm(), 1e-9);
    EXPECT_EQ(hands.scene.camera(), before);
}

TEST(SceneMouse, with_the_probe_in_hand_the_camera_still_turns_pans_and_zooms) {
    Hands hands;
    set(hands.scene, &Shown::probe, true);
    hands.drag(Qt::RightButton, {200, 160}, {240, 160});
    const Vec3 turned = hands.scene.camera().towards_viewer;
    EXPECT_LT(turned[0], -0.2);
    hands.drag(Qt::LeftButton, {200, 160}, {160, 160}, Qt::AltModifier);
    EXPECT_NEAR(hands.scene.camera().towards_viewer[0], 0, 1e-9);
    const Vec3 focus = hands.scene.camera().focus;
    hands.drag(Qt::MiddleButton, {200, 160}, {240, 160});
    EXPECT_GT((hands.scene.camera().focus - focus).norm(), 5);
    hands.wheel({200, 160}, 2, Qt::ControlModifier);
    EXPECT_LT(hands.scene.camera().half_height, 30);
    EXPECT_EQ(hands.dragged, Vec3::Zero());
}

TEST(SceneMouse, a_camera_that_is_set_is_used_and_an_impossible_one_is_refused) {
    Hands hands;
    const Camera camera{Vec3(1, 2, 3), Vec3(1, 1, 0), Vec3(0, 0, 1), 12};
    hands.scene.set_camera(camera);
    EXPECT_EQ(hands.scene.camera(), camera);
    Camera flat = camera;
    flat.up = camera.towards_viewer;
    EXPECT_THROW(hands.scene.set_camera(flat), std::invalid_argument);
    Camera none = camera;
    none.half_height = 0;
    EXPECT_THROW(hands.scene.set_camera(none), std::invalid_argument);
    hands.scene.look_from(pictures::view_named("top"));
    EXPECT_EQ(hands.scene.camera().half_height, 12);
    EXPECT_EQ(hands.scene.camera().focus, camera.focus);
    EXPECT_EQ(hands.scene.camera().towards_viewer, Vec3(0, 0, 1));
}

TEST(SceneMouse, a_view_of_the_whole_stays_one_when_the_window_changes_its_shape) {
    Hands hands;
    hands.scene.reset_camera();
    const double wide = hands.scene.camera().half_height;
    hands.scene.resize(160, 320);
    hands.settled();
    EXPECT_GT(hands.scene.camera().half_height, 1.4 * wide);
    hands.scene.set_camera(hands.scene.camera());
    const double own = hands.scene.camera().half_height;
    hands.scene.resize(400, 320);
    hands.settled();
    EXPECT_EQ(hands.scene.camera().half_height, own);
}

TEST(SceneMouse, ctrl_and_left_drag_turn_the_tool_where_the_mouse_is_the_hand) {
    Hands hands;
    Vec3 turn = Vec3::Zero();
    QObject::connect(&hands.scene, &Scene::tool_turned, [&](const Vec3& by) { turn += by; });
    const Camera before = hands.scene.camera();
    hands.drag(Qt::LeftButton, {200, 160}, {280, 160}, Qt::ControlModifier);
    EXPECT_EQ(turn, Vec3::Zero()) << "the mouse is not the hand";
    hands.scene.set_camera(before);
    set(hands.scene, &Shown::probe, true);
    // 80 pixels of 320: 45 degrees; the side towards the viewer (-y) goes to the right (+x).
    hands.drag(Qt::LeftButton, {200, 160}, {280, 160}, Qt::ControlModifier);
    EXPECT_NEAR(turn.norm(), std::acos(-1.0) / 4, 1e-9);
    const Mat3 rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    EXPECT_GT((rotation * Vec3(0, -1, 0))[0], 0.5);
    turn.setZero();
    hands.drag(Qt::LeftButton, {200, 160}, {200, 80}, Qt::ControlModifier);
    const Mat3 up = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    EXPECT_GT((up * Vec3(0, -1, 0))[2], 0.5) << "and up";
    EXPECT_EQ(hands.dragged, Vec3::Zero());
    EXPECT_EQ(hands.scene.camera(), before);
}

}  // namespace
}  // namespace palpate::viewer
