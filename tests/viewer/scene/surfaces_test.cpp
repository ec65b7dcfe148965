// Several surfaces, cuts and the patch round a hand that presses through.
#include <gtest/gtest.h>

#include "apps/viewer/scene/cut.hpp"
#include "apps/viewer/scene/hand_marks.hpp"
#include "apps/viewer/scene/layer_prop.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/fields.hpp"
#include "viewer/scene/shown_scene.hpp"

namespace palpate::viewer {
namespace {

constexpr Colour red{0.8, 0.1, 0.1}, green{0.1, 0.7, 0.1};

bool is_red(QRgb p) {
    return qRed(p) > qGreen(p) + 40 && qRed(p) > qBlue(p) + 40;
}

/// A ball of 32 voxels, seen from the front; 0.2 mm a pixel.
struct Ball : ShownScene {
    Field field = linear_field(scenes::ball(support::cube(32)));

    explicit Ball(const Look& look) {
        set(scene, &Shown::look, look);
        scene.set_field(field, 128);
        scene.set_camera({Vec3::Zero(), Vec3(0, -1, 0), Vec3(0, 0, 1), 32});
    }
    double radius_at(double level) const {
        const RayHit hit = cast_ray(field, level, Vec3(-20, 0, 0), Vec3(0, 0, 0));
        return hit.hit ? hit.point.norm() : 0;
    }
};

TEST(DrawnSurfaces, are_seen_beside_the_felt_one_where_their_levels_lie) {
    Look look = bare();
    look.surface = false;
    look.surfaces = {{60, red, 1, true}};
    Ball shown(look);
    const Blob outer = blob(shown.settled("surfaces_one"), is_red);
    EXPECT_NEAR(outer.right - outer.left + 1, 2 * shown.radius_at(60) / 0.2, 3);
    look.surfaces[0].level = 200;  // moved
    set(shown.scene, &Shown::look, look);
    const Blob inner = blob(shown.settled(), is_red);
    EXPECT_NEAR(inner.right - inner.left + 1, 2 * shown.radius_at(200) / 0.2, 3);
    EXPECT_LT(inner.count, outer.count);
    look.surfaces[0].shown = false;
    set(shown.scene, &Shown::look, look);
    EXPECT_EQ(blob(shown.settled(), is_red).count, 0);
}

TEST(DrawnSurfaces, an_inner_one_is_seen_through_glass_and_glass_through_glass) {
    Look look = bare();
    look.surface_opacity = 0.3;
    look.surfaces = {{220, red, 1, true}, {60, green, 0.3, true}};
    Ball shown(look);
    const QImage image = shown.settled("surfaces_three");
    const QRgb middle = image.pixel(200, 160);
    look.surfaces[0].shown = false;
    set(shown.scene, &Shown::look, look);
    const QRgb without = shown.settled().pixel(200, 160);
    EXPECT_GT(qRed(middle) - qGreen(middle), qRed(without) - qGreen(without) + 30);
    // The outermost is there as well: green at the rim, where the felt one is not.
    const int x = 200 + int(0.5 * (shown.radius_at(60) + shown.radius_at(128)) / 0.2);
    const QRgb rim = image.pixel(x, 160);
    EXPECT_GT(qGreen(rim), qRed(rim) + 10);
}

TEST(DrawnSurfaces, of_another_volume_are_its_own_and_all_follow_edits) {
    Look look = bare();
    look.surface = false;
    look.surfaces = {{128, red, 1, true}};
    Ball shown(look);
    shown.settled();
    Field edited_field = shown.field;
    edited_field.use(
        edited(edited_field.shared_samples(), edit::Fill{{Index3(16, 0, 0), Index3(31, 31, 31)}, 0})
            .samples);
    shown.scene.update_field(edited_field);
    const Blob half = blob(shown.settled("surfaces_edited"), is_red);
    EXPECT_NEAR(half.right, 200, 4);
    EXPECT_LT(half.left, 160);
    shown.scene.set_field(linear_field(scenes::ball(support::cube(16))), 128);
    shown.scene.set_camera({Vec3::Zero(), Vec3(0, -1, 0), Vec3(0, 0, 1), 32});
    const Blob small = blob(shown.settled(), is_red);
    EXPECT_LT(small.right - small.left, half.bottom - half.top);
}

TEST(DrawnSurfaces, can_be_changed_at_any_time) {
    Look look = bare();
    Ball shown(look);
    support::Random random(7);
    for (int i = 0; i < 60; ++i) {
        look.surfaces.resize(std::size_t(random.uniform(0, 5)));
        for (SeenSurface& s : look.surfaces) {
            s = {random.uniform(20, 240), red, random.uniform(0, 1.5), random.uniform(0, 1) < 0.8};
        }
        look.cut = static_cast<Cut>(i % 3);
        set(shown.scene, &Shown::look, look);
        if (i % 4 == 0) shown.next_frame();
        if (i % 20 == 9) shown.scene.clear();
        if (i % 20 == 14) shown.scene.set_field(shown.field, 100 + i);
    }
    shown.settled();
}

TEST(DrawnCut, a_plane_takes_away_the_side_of_its_normal_and_shows_what_is_behind) {
    Look look = bare();
    look.surfaces = {{220, red, 1, true}};
    Ball shown(look);
    EXPECT_EQ(blob(shown.settled(), is_red).count, 0);
    look.cut = Cut::plane;
    look.cut_plane = {Vec3::Zero(), Vec3(0, -1, 0)};  // the front half
    set(shown.scene, &Shown::look, look);
    EXPECT_GT(blob(shown.settled("cut_plane"), is_red).count, 500);
    look.cut_plane.normal = Vec3(1, 0, 0);
    set(shown.scene, &Shown::look, look);
    const Blob left = blob(shown.settled("cut_left"), is_bone);
    EXPECT_LE(left.right, 203);
    EXPECT_LT(left.left, 160);
    look.cut = Cut::nothing;
    set(shown.scene, &Shown::look, look);
    EXPECT_GT(blob(shown.settled(), is_bone).right, 230);
}

TEST(DrawnCut, a_box_keeps_what_is_inside) {
    Look look = bare();
    look.cut = Cut::box;
    look.cut_box = {{0, 0, 0.5}, {1, 1, 1}};
    Ball shown(look);
    const Blob upper = blob(shown.settled("cut_box"), is_bone);
    EXPECT_NEAR(upper.bottom, 160, 3);
    EXPECT_LT(upper.top, 120);
}

TEST(DrawnCut, the_volume_is_cut_too) {
    Look look = bare();
    look.surface = false;
    look.volume = true;
    look.transfer.points = {{100, red, 0}, {120, red, 0.9}};
    look.cut = Cut::plane;
    look.cut_plane = {Vec3::Zero(), Vec3(1, 0, 0)};
    Ball shown(look);
    const Blob half = blob(shown.settled("cut_volume"), is_red);
    EXPECT_LE(half.right, 205);
    EXPECT_GT(half.count, 500);
}

/// Handles of the cut, dragged with the left button.
struct Cutting : Ball {
    Look now;

    explicit Cutting(const Look& look) : Ball(look) {
        QObject::connect(&scene, &Scene::cut_moved, [this](const Look& moved) { now = moved; });
    }
    void drag(const Vec3& handle, const QPointF& by) {
        const Pixel from = at(handle);
        const QPoint start = QPointF(from.x, from.y).toPoint();
        QTest::mousePress(&scene, Qt::LeftButton, Qt::NoModifier, start);
        for (int i = 1; i <= 4; ++i) {
            const QPointF to = start + by * i / 4;
            QMouseEvent move(QEvent::MouseMove, to, scene.mapToGlobal(to.toPoint()), Qt::NoButton,
                             Qt::LeftButton, Qt::NoModifier);
            QCoreApplication::sendEvent(&scene, &move);
        }
        QTest::mouseRelease(&scene, Qt::LeftButton, Qt::NoModifier, start + by.toPoint());
    }
};

TEST(SceneCut, handles_move_and_turn_the_plane_and_the_camera_stays) {
    Look look = bare();
    look.cut = Cut::plane;
    look.cut_plane = {Vec3::Zero(), Vec3(1, 0, 0)};
    Cutting shown(look);
    const pictures::Camera before = shown.scene.camera();
    shown.settled("cut_handles");
    shown.drag(Vec3::Zero(), {25, 10});  // along its normal alone
    EXPECT_NEAR((shown.now.cut_plane.point - Vec3(5, 0, 0)).norm(), 0, 1e-9);
    EXPECT_EQ(shown.now.cut_plane.normal, Vec3(1, 0, 0));
    const Vec3 tip = Vec3(5, 0, 0) + 0.2 * 70 * Vec3(1, 0, 0);
    shown.drag(tip, {-70, -70});  // 14 mm to the left and up
    EXPECT_NEAR((shown.now.cut_plane.normal - Vec3(0, 0, 1)).norm(), 0, 1e-9);
    EXPECT_EQ(shown.scene.camera().towards_viewer, before.towards_viewer);
    EXPECT_EQ(shown.scene.camera().focus, before.focus);
}

TEST(SceneCut, handles_move_faces_of_the_box_within_the_grid_and_past_no_other) {
    Look look = bare();
    look.cut = Cut::box;
    Cutting shown(look);
    const Geometry& g = shown.field.geometry();
    const auto handle = [&](std::size_t i) { return handles_of(shown.now, g, 1).at(i).at; };
    shown.now = look;
    shown.drag(handle(0), {31, 0});  // 6.2 mm of 31
    EXPECT_NEAR(shown.now.cut_box.low[0], 0.2, 1e-6);
    shown.drag(handle(1), {50, 0});
    EXPECT_EQ(shown.now.cut_box.high[0], 1);
    shown.drag(handle(5), {0, 390});
    EXPECT_NEAR(shown.now.cut_box.high[2], shown.now.cut_box.low[2] + 0.01, 1e-9);
}

TEST(SceneCut, handles_that_move_while_layers_are_seen_change_nothing_else_of_the_look) {
    Look look = bare();
    look.cut = Cut::plane;
    look.cut_plane = {Vec3::Zero(), Vec3(1, 0, 0)};
    Cutting shown(look);
    const auto layers = std::make_shared<Layers>();
    layers->layers.resize(2);
    layers->layers[0].level = 100;
    layers->layers[1].level = 140;
    set(shown.scene, &Shown::layers, layers);
    shown.drag(Vec3::Zero(), {25, 10});
    EXPECT_NE(shown.now.cut_plane.point, Vec3::Zero());
    shown.now.cut_plane = look.cut_plane;
    EXPECT_TRUE(shown.now == look);
}

TEST(CutHandles, of_a_box_at_the_edge_thinner_than_they_make_one_leave_it_within_the_grid) {
    const Geometry g = support::grid(support::cube(11));
    Look look;
    look.cut = Cut::box;
    look.cut_box = {{0, 0.995, 0}, {0.005, 1, 1}};  // as a session may hold it
    for (const double to : {-3.0, 0.02, 5.0, 9.99, 13.0}) {
        const CutBox low = with_handle_at(look, g, 0, Vec3::Constant(to)).cut_box;
        EXPECT_EQ(low.low[0], 0) << to;
        EXPECT_EQ(low.high[0], 0.005) << to;
        const CutBox high = with_handle_at(look, g, 3, Vec3::Constant(to)).cut_box;
        EXPECT_EQ(high.low[1], 0.995) << to;
        EXPECT_EQ(high.high[1], 1) << to;
    }
}

TEST(CutPlanes, of_a_box_are_those_of_the_ends_that_cut) {
    Look look;
    look.cut = Cut::box;
    const Geometry g =
        support::grid({11, 21, 31}, {1, 2, 0.5}, {5, 6, 7}, support::oblique_direction());
    EXPECT_TRUE(planes_of(look, g).empty());
    look.cut_box = {{0.1, 0, 0}, {1, 1, 0.5}};
    const auto planes = planes_of(look, g);
    ASSERT_EQ(planes.size(), 2U);
    const auto is_cut = [&](const Vec3& index) {
        const Vec3 at = physical_from_index(g, index);
        return std::ranges::any_of(
            planes, [&](const CutPlane& p) { return p.normal.dot(at - p.point) > 0; });
    };
    EXPECT_TRUE(is_cut({0.9, 10, 10}));
    EXPECT_FALSE(is_cut({1.1, 0, 0}));
    EXPECT_FALSE(is_cut({10, 20, 14.9}));
    EXPECT_TRUE(is_cut({5, 5, 15.1}));
}

TEST(Compose, puts_the_nearest_over_the_others_at_each_pixel_and_leaves_out_what_is_hidden) {
    const auto layer = [](std::vector<unsigned char> rgba, std::vector<float> depth) {
        return pictures::Layer{std::move(rgba), std::move(depth)};
    };
    // Four pixels: a over b; b over a; b behind the solid; nothing.
    const pictures::Layer a =
        layer({200, 0, 0, 128, 200, 0, 0, 128, 200, 0, 0, 128, 9, 9, 9, 0}, {0.2F, 0.6F, 0.2F, 1});
    const pictures::Layer b =
        layer({0, 100, 0, 255, 0, 100, 0, 255, 0, 100, 0, 255, 9, 9, 9, 0}, {0.5F, 0.4F, 0.8F, 1});
    const pictures::Layer solid = layer(std::vector<unsigned char>(16), {1, 1, 0.7F, 1});
    const pictures::Layer both = composed({a, b}, solid);
    const auto pixel = [&](std::size_t i) {
        return std::vector<int>(both.rgba.begin() + std::ptrdiff_t(4 * i),
                                both.rgba.begin() + std::ptrdiff_t(4 * i + 4));
    };
    EXPECT_EQ(pixel(0), (std::vector{100, 50, 0, 255}));
    EXPECT_EQ(pixel(1), (std::vector{0, 100, 0, 255}));
    EXPECT_EQ(pixel(2), (std::vector{200, 0, 0, 128}));
    EXPECT_EQ(pixel(3)[3], 0);
    EXPECT_EQ(both.depth, (std::vector<float>{0.2F, 0.4F, 0.2F, 1}));
    EXPECT_TRUE(composed({}, solid).rgba.empty());
    EXPECT_EQ(composed({a}, solid).rgba, a.rgba);
}

TEST(DrawnPatch, of_the_level_felt_is_seen_through_the_surface_that_was_pressed_through) {
    Ball shown(bare());
    const double radius = shown.radius_at(220);
    const Vec3 scp(0, -radius, 0);
    shown.scene.show_snapshot(snapshot_at(scp + Vec3(0, 0.5, 0), scp));
    const QImage whole = shown.settled();
    set(shown.scene, &Shown::pressed, 220);
    const QImage pressed = shown.settled("pressed");
    EXPECT_GT(difference(whole, pressed), 3);
    set(shown.scene, &Shown::pressed, {});
    EXPECT_LT(difference(whole, shown.settled()), 0.5);
}

TEST(ScenePatch, lies_on_the_isosurface_near_the_point) {
    const Field field = linear_field(scenes::ball(support::cube(48)));
    const Vec3 at = cast_ray(field, 128, Vec3(-40, 1, 2), Vec3(0, 1, 2)).point;
    const auto patch = local_patch(field, at, 128);
    ASSERT_TRUE(patch);
    ASSERT_GT(patch->triangle_count(), 100U);
    for (const std::int32_t v : patch->triangles) {
        const float* p = patch->positions.data() + 3 * std::ptrdiff_t(v);
        const Vec3 physical = Vec3(p[0], p[1], p[2]) + physical_centre(field.geometry());
        ASSERT_LT((physical - at).norm(), 12);
        ASSERT_NEAR(value_at(field, physical), 128, 0.01);
    }
    EXPECT_FALSE(local_patch(field, at, 1000));
    EXPECT_FALSE(local_patch(field, Vec3::Constant(1e9), 128));
}

}  // namespace
}  // namespace palpate::viewer
