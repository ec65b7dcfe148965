// The 3-D view: what is drawn, and when.
#include "apps/viewer/scene/scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "apps/viewer/scene/render_request.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/fields.hpp"
#include "viewer/scene/shown_scene.hpp"

namespace palpate::viewer {
namespace {

constexpr double radius = 0.35 * 48;

/// A ball of that radius [mm] round the middle of its grid.
Field ball(const Vec3& origin = Vec3::Zero()) {
    Volume volume = scenes::ball(support::cube(48), 0.35, 1.4, SampleType::float32);
    Geometry geometry = volume.geometry();
    geometry.origin = origin;
    const auto samples = volume.samples<float>();
    return linear_field(Volume(geometry, std::vector<float>(samples.begin(), samples.end())));
}

/// From the front, so that a millimetre is 4 pixels in a picture of 400 x 320.
Camera from_front(const Field& field, double half_height = 40) {
    return {physical_centre(field.geometry()), Vec3(0, -1, 0), Vec3(0, 0, 1), half_height};
}

/// A ball seen from the front.
struct ShownBall : ShownScene {
    explicit ShownBall(double level, const Look& look = bare(), const Vec3& origin = Vec3::Zero())
        : field(ball(origin)) {
        set(scene, &Shown::look, look);
        scene.set_field(field, level);
        scene.set_camera(from_front(field));
    }
    const Field field;
};

TEST(DrawnScene, shows_a_ball_as_large_as_it_is_where_it_is) {
    // Far from the origin, as scanners do.
    ShownBall shown(0.5, bare(), Vec3(-300, 120, 1500));
    const Blob seen = blob(shown.settled("ball"), is_bone);
    EXPECT_NEAR(seen.x, 200, 1);
    EXPECT_NEAR(seen.y, 160, 1);
    EXPECT_NEAR(seen.right - seen.left + 1, 2 * radius * 4, 3);
    EXPECT_NEAR(seen.bottom - seen.top + 1, 2 * radius * 4, 3);
    EXPECT_NEAR(seen.count, 3.14159 * radius * radius * 16, 500);
}

TEST(DrawnScene, keeps_its_shape_until_there_is_a_picture_of_another_size) {
    ShownBall shown(0.5);
    shown.settled();
    for (const int width : {200, 800}) {
        shown.scene.resize(width, 320);
        const Blob seen = blob(shown.scene.picture(), is_bone);
        EXPECT_NEAR(seen.x, 0.5 * width, 2);
        EXPECT_NEAR(seen.right - seen.left, seen.bottom - seen.top, 4) << width;
    }
}

TEST(DrawnScene, is_empty_before_a_field_and_after_it_is_cleared) {
    ShownScene shown;
    const QImage before = shown.settled();
    EXPECT_EQ(blob(before, [&](QRgb p) { return p != before.pixel(0, 0); }).count, 0);
    shown.scene.set_field(ball(), 0.5);
    EXPECT_GT(difference(shown.settled(), before), 5);
    shown.scene.clear();
    EXPECT_EQ(difference(shown.settled(), before), 0);
}

TEST(DrawnScene, mirrored_and_oblique_grids_are_seen_where_their_samples_lie) {
    Mat3 mirrored = Mat3::Identity();
    mirrored(0, 0) = -1;
    Mat3 oblique = support::oblique_direction();
    oblique.col(2) *= -1;
    for (const bool volume : {false, true}) {
        for (const Mat3& direction : {mirrored, oblique}) {
            // A bright corner at low indices, nothing else.
            const Field field = linear_field(support::volume_of<std::uint8_t>(
                support::grid(Index3(32, 24, 20), Vec3(1, 1.5, 2), Vec3(40, -70, 12), direction),
                [](const Index3& i) { return (i - Index3(6, 5, 4)).norm() < 4 ? 200 : 0; }));
            ShownScene shown;
            Look look = bare();
            look.surface = !volume;
            look.volume = volume;
            look.transfer.points = {{50, pictures::bone, 0}, {120, pictures::bone, 1}};
            set(shown.scene, &Shown::look, look);
            shown.scene.set_field(field, 100);
            for (const char* view : {"front", "left", "top"}) {
                shown.scene.look_from(pictures::view_named(view));
                const QImage image = shown.settled(volume ? "oblique_volume" : "oblique_surface");
                const Blob seen = blob(image, is_bone);
                const Pixel expected =
                    shown.at(physical_from_index(field.geometry(), Vec3(6, 5, 4)));
                ASSERT_GT(seen.count, 100) << view << volume;
                EXPECT_NEAR(seen.x, expected.x, 2.5) << view << volume;
                EXPECT_NEAR(seen.y, expected.y, 2.5) << view << volume;
            }
        }
    }
}

TEST(DrawnScene, hand_and_proxy_are_balls_of_their_colours_at_their_places) {
    ShownBall shown(0.9);
    const Field& field = shown.field;
    const Vec3 middle = physical_centre(field.geometry());
    const Vec3 hip = middle + Vec3(-22, -25, 20), scp = middle + Vec3(24, -25, -17);
    shown.scene.show_snapshot(snapshot_at(hip, scp));
    const QImage image = shown.settled("markers");
    const Blob blue = blob(image, is_blue), vermilion = blob(image, is_vermilion);
    EXPECT_NEAR(blue.x, shown.at(hip).x, 2.5);
    EXPECT_NEAR(blue.y, shown.at(hip).y, 2.5);
    EXPECT_NEAR(vermilion.x, shown.at(scp).x, 2.5);
    EXPECT_NEAR(vermilion.y, shown.at(scp).y, 2.5);
    // As large however near one looks.
    EXPECT_NEAR(blue.right - blue.left, 17, 2);
    shown.scene.set_camera(from_front(field, 27));
    const Blob nearer = blob(shown.settled(), is_blue);
    EXPECT_NEAR(nearer.right - nearer.left, 17, 2);
    // One ball where the hand is free.
    shown.scene.show_snapshot(snapshot_at(hip, hip));
    EXPECT_EQ(blob(shown.settled(), is_vermilion).count, 0);
}

TEST(DrawnScene, a_second_hand_is_drawn_in_lighter_colours_with_its_force) {
    ShownBall shown(0.9);
    const Field& field = shown.field;
    const Vec3 middle = physical_centre(field.geometry());
    const Vec3 hip = middle + Vec3(-22, -25, 20), scp = middle + Vec3(24, -25, 17);
    const Vec3 other_hip = middle + Vec3(-22, -25, -20), other_scp = middle + Vec3(24, -25, -17);
    shown.scene.show_snapshot(snapshot_at(hip, scp));
    shown.scene.show_snapshot(snapshot_at(other_hip, other_scp, Vec3(0, 0, 0.5)), 2);
    const QImage image = shown.settled("two-hands");
    const auto is_sky_blue = [](QRgb p) { return is_blue(p) && 4 * qRed(p) > qBlue(p); };
    const auto is_orange = [](QRgb p) { return is_vermilion(p) && 5 * qGreen(p) > 3 * qRed(p); };
    const auto expect_at = [&](const Blob& blob, const Vec3& at) {
        EXPECT_NEAR(blob.x, shown.at(at).x, 3);
        EXPECT_NEAR(blob.y, shown.at(at).y, 3);
    };
    expect_at(blob(image, [&](QRgb p) { return is_blue(p) && !is_sky_blue(p); }), hip);
    expect_at(blob(image, is_sky_blue), other_hip);
    expect_at(blob(image, is_orange), other_scp);
    EXPECT_GT(blob(image, is_green).count, 50);
    shown.scene.show_snapshot({}, 2);
    const QImage alone = shown.settled();
    EXPECT_EQ(blob(alone, is_sky_blue).count + blob(alone, is_green).count, 0);
    EXPECT_GT(blob(alone, is_blue).count, 50);
}

TEST(DrawnScene, force_points_where_it_points_in_the_body_and_is_longer_when_stronger) {
    ShownBall shown(0.9);
    const Field& field = shown.field;
    const Vec3 at = physical_centre(field.geometry()) + Vec3(-30, -30, -25);
    Snapshot snapshot = snapshot_at(at, at, Vec3(0, 0, 1));
    // The device's z is the body's left (+x), to the right in this view.
    snapshot.session.transform.rotation << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    shown.scene.show_snapshot(snapshot);
    const Blob arrow = blob(shown.settled("force"), is_green);
    EXPECT_NEAR(arrow.right, shown.at(at).x + 100, 4);
    EXPECT_NEAR(arrow.y, shown.at(at).y, 3);
    snapshot.number += 1'000'000;
    snapshot.session.tick.force *= 2;
    shown.scene.show_snapshot(snapshot);
    EXPECT_NEAR(blob(shown.settled(), is_green).right, shown.at(at).x + 200, 4);
}

TEST(DrawnScene, no_probe_is_shown_while_the_device_is_not_ready_or_contact_is_off) {
    ShownBall shown(0.5);
    const Field& field = shown.field;
    const Vec3 at = physical_centre(field.geometry()) + Vec3(-22, -25, 20);
    for (const DeviceStatus status :
         {DeviceStatus::starting, DeviceStatus::lost, DeviceStatus::stale}) {
        Snapshot snapshot = snapshot_at(at, at);
        snapshot.session.device.status = status;
        shown.scene.show_snapshot(snapshot);
        EXPECT_EQ(blob(shown.settled(), is_blue).count, 0);
    }
    shown.scene.show_snapshot(snapshot_at(at, at));
    EXPECT_GT(blob(shown.settled(), is_blue).count, 100);
    Look look = bare();
    look.contact = false;
    set(shown.scene, &Shown::look, look);
    EXPECT_EQ(blob(shown.settled(), is_blue).count, 0);
    set(shown.scene, &Shown::look, bare());
    EXPECT_GT(blob(shown.settled(), is_blue).count, 100);
    shown.scene.show_snapshot({});
    EXPECT_EQ(blob(shown.settled(), is_blue).count, 0);
}

TEST(DrawnScene, markers_behind_the_surface_are_faintly_visible) {
    ShownBall shown(0.5);
    const Field& field = shown.field;
    const QImage without = shown.settled();
    const Vec3 middle = physical_centre(field.geometry());
    const auto blueness = [](QRgb p) { return qBlue(p) - qRed(p); };
    shown.scene.show_snapshot(snapshot_at(middle, middle));
    const int inside = blueness(shown.settled("faint").pixel(200, 160));
    const Vec3 before = middle + Vec3(0, -30, 0);
    shown.scene.show_snapshot(snapshot_at(before, before));
    const int in_front = blueness(shown.settled().pixel(200, 160));
    EXPECT_GT(inside, blueness(without.pixel(200, 160)) + 30);
    EXPECT_GT(in_front, inside + 30);
}

TEST(DrawnScene, glass_lets_the_probe_through_and_tints_it) {
    Look look = bare();
    look.surface_opacity = 0.3;
    ShownBall shown(0.5, look);
    const Field& field = shown.field;
    const Vec3 middle = physical_centre(field.geometry());
    shown.scene.show_snapshot(snapshot_at(middle, middle));
    const QImage image = shown.settled("glass");
    const Blob blue = blob(image, is_blue);
    EXPECT_GT(blue.count, 150);
    // Denser towards the outline than in the middle, and the paper shines through both.
    const QRgb paper = image.pixel(2, 2), thin = image.pixel(225, 160),
               thick = image.pixel(262, 160);
    EXPECT_LT(qBlue(thin), qBlue(paper) - 5);
    EXPECT_LT(qBlue(thick), qBlue(thin));
}

TEST(DrawnScene, after_a_sweep_of_fifty_isovalues_the_newest_is_shown) {
    ShownBall shown(0.1);
    double announced = 0;
    QObject::connect(&shown.scene, &Scene::surface_ready,
                     [&](double isovalue, double) { announced = isovalue; });
    for (int i = 0; i < 50; ++i) {
        set(shown.scene, &Shown::isovalue, 0.2 + 0.01 * i);
        handle_events();
    }
    const Blob seen = blob(shown.settled("sweep"), is_bone);
    EXPECT_DOUBLE_EQ(announced, 0.2 + 0.01 * 49);
    // density = 1/2 + 1.4 (0.35 - r) in units of the grid's 48 mm
    const double expected = 48 * (0.35 - (announced - 0.5) / 1.4);
    EXPECT_NEAR(seen.right - seen.left + 1, 2 * expected * 4, 3);
}

TEST(DrawnScene,
     an_isovalue_outside_the_data_shows_no_surface_and_one_that_is_no_number_is_a_problem) {
    ShownScene shown;
    const Field field = ball();
    set(shown.scene, &Shown::look, bare());
    int problems = 0;
    QObject::connect(&shown.scene, &Scene::problem, [&](const QString&) { ++problems; });
    shown.scene.set_field(field, 7);
    EXPECT_EQ(blob(shown.settled(), is_bone).count, 0);
    EXPECT_EQ(problems, 0);
    set(shown.scene, &Shown::isovalue, std::numeric_limits<double>::quiet_NaN());
    shown.settled();
    EXPECT_EQ(problems, 1);
    set(shown.scene, &Shown::isovalue, 0.5);
    EXPECT_GT(blob(shown.settled(), is_bone).count, 1000);
}

TEST(DrawnScene, slices_cut_at_the_crosshair) {
    // Bright where x is high: the plane across x is bright or dark with the crosshair.
    const Field field = linear_field(support::volume_of<std::uint8_t>(
        support::grid(support::cube(32)), [](const Index3& i) { return i[0] * 8; }));
    ShownScene shown;
    Look look = bare();
    look.surface = false;
    look.slices = true;
    set(shown.scene, &Shown::look, look);
    shown.scene.set_field(field, 0);
    shown.scene.look_from(pictures::view_named("left"));  // looks along -x at that plane
    for (const double x : {4.0, 20.5, 30.0}) {
        set(shown.scene, &Shown::crosshair, Vec3(x, 16, 16));
        const QImage image = shown.settled("slices");
        const Pixel p = shown.at(Vec3(x, 8, 24));
        EXPECT_NEAR(qRed(image.pixel(int(p.x), int(p.y))), x / 31 * 255, 3) << x;
    }
}

TEST(DrawnScene, a_maximum_intensity_projection_shows_the_brightest_sample_of_each_line_of_sight) {
    // A dim block, and behind it, hidden in every other way, a bright rod.
    const Field field = linear_field(
        support::volume_of<std::uint8_t>(support::grid(support::cube(32)), [](const Index3& i) {
            if (i[1] > 24 && std::abs(i[0] - 10) < 3) return 240;
            return (i.array() > 3).all() && (i.array() < 28).all() ? 80 : 0;
        }));
    ShownScene shown;
    Look look = bare();
    look.surface = false;
    look.volume = true;
    look.maximum = true;
    look.transfer.points = {{0, pictures::bone, 0}, {255, pictures::bone, 1}};
    set(shown.scene, &Shown::look, look);
    shown.scene.set_field(field, 128);
    shown.scene.look_from(pictures::view_named("front"));
    const QImage image = shown.settled("maximum");
    const auto grey = [&](const Vec3& at) {
        const Pixel p = shown.at(at);
        return qGray(image.pixel(int(p.x), int(p.y)));
    };
    const int rod = grey({10, 16, 16}), block = grey({22, 16, 16});
    EXPECT_GT(rod, 200);
    EXPECT_LT(block, rod - 60);
    // Composed, the block hides the rod.
    look.maximum = false;
    look.transfer.points = {{0, pictures::bone, 0}, {60, pictures::bone, 1}, {255, {0, 0, 0}, 1}};
    look.shading = false;
    set(shown.scene, &Shown::look, look);
    const QImage composed = shown.settled();
    const auto red = [&](const Vec3& at) {
        const Pixel p = shown.at(at);
        return qRed(composed.pixel(int(p.x), int(p.y)));
    };
    EXPECT_NEAR(red({10, 16, 16}), red({22, 16, 16}), 4);
}

/// An L has nothing at its upper right; on its side it would, as letters at the edges would.
TEST(DrawnScene, the_orientation_cube_seen_straight_on_has_one_upright_letter_and_an_edge) {
    ShownScene shown;
    Look look = bare();
    look.orientation = true;
    look.surface = false;
    set(shown.scene, &Shown::look, look);
    Geometry grid = support::grid(support::cube(8));
    grid.oriented = true;
    shown.scene.set_field(
        linear_field(support::volume_of<std::uint8_t>(grid, [](const Index3&) { return 0; })), 128);
    shown.scene.look_from(pictures::view_named("left"));
    const QImage image = shown.settled("cube");
    const Blob letter = blob(image, [](QRgb p) { return qGray(p) < 80; });
    const Blob edge = blob(image, [](QRgb p) { return qGray(p) < 200; });
    ASSERT_GT(letter.count, 20);
    EXPECT_LT(edge.left, letter.left);
    EXPECT_GT(edge.right, letter.right);
    const int right = (letter.left + letter.right + 1) / 2;
    const int lower = (letter.top + letter.bottom + 1) / 2;
    for (int y = letter.top; y < lower; ++y) {
        for (int x = right; x <= letter.right; ++x) {
            EXPECT_GE(qGray(image.pixel(x, y)), 80) << x << ", " << y;
        }
    }
}

TEST(DrawnScene, can_be_destroyed_while_it_renders) {
    const Field noise = linear_field(
        support::noise_volume<std::uint8_t>(support::grid(support::cube(128)), 3, 0, 256));
    for (const int frames : {0, 1, 2}) {
        auto shown = std::make_unique<ShownScene>();
        Look look;
        look.volume = true;
        look.transfer.points = {{0, pictures::bone, 0}, {255, pictures::bone, 0.5}};
        set(shown->scene, &Shown::look, look);
        shown->scene.set_field(noise, 128);
        for (int i = 0; i < frames; ++i) shown->next_frame();
        shown.reset();
    }
    Scene never_shown;
    never_shown.set_field(noise, 128);
}

TEST(DrawnScene, asks_for_nothing_while_nothing_changes) {
    ShownScene shown;
    shown.scene.set_field(ball(), 0.5);
    shown.settled();
    // Once the window has shown it nothing waits, and what there is to handle asks for no frame.
    const auto comes_to_rest = [&] {
        wait_until_quiet(shown.scene);
        const int before = shown.frames;
        for (int i = 0; i < 50; ++i) handle_events();
        return shown.frames == before && !holds_back(shown.scene);
    };
    handle_events();
    EXPECT_TRUE(comes_to_rest());
    set(shown.scene, &Shown::look, Look());  // the same
    const Snapshot snapshot = snapshot_at(Vec3::Zero(), Vec3::Zero());
    shown.scene.show_snapshot(snapshot);
    shown.settled();
    EXPECT_TRUE(comes_to_rest());
    const int before = shown.frames;
    for (int i = 0; i < 20; ++i) {
        shown.scene.show_snapshot(snapshot);
        EXPECT_TRUE(comes_to_rest());
    }
    EXPECT_EQ(shown.frames, before);
}

TEST(Scene, tells_graphics_hardware_from_the_processor) {
    for (const char* name : {"llvmpipe (LLVM 15.0.6, 256 bits)", "softpipe", "SWR (LLVM 12.0)",
                             "Software Rasterizer", "Apple Software Renderer", ""}) {
        EXPECT_FALSE(is_hardware(name)) << name;
    }
    for (const char* name : {"Mesa Intel(R) UHD Graphics 620 (KBL GT2)",
                             "NVIDIA GeForce RTX 3080/PCIe/SSE2", "AMD Radeon RX 6800 (navi21)"}) {
        EXPECT_TRUE(is_hardware(name)) << name;
    }
}

TEST(DrawnScene, follows_a_dark_palette) {
    ShownScene shown;
    shown.scene.set_field(ball(), 0.5);
    EXPECT_GT(qGray(shown.settled().pixel(3, 3)), 220);
    QPalette dark;
    dark.setColor(QPalette::Window, QColor(40, 40, 44));
    dark.setColor(QPalette::WindowText, QColor(230, 230, 230));
    shown.scene.setPalette(dark);
    const QImage image = shown.settled("dark");
    EXPECT_LT(qGray(image.pixel(3, 3)), 60);
}

TEST(DrawnScene, shows_the_lattice_round_the_proxy_on_request) {
    ShownScene shown;
    const Field field = ball();
    Look look = bare();
    look.surface = false;
    set(shown.scene, &Shown::look, look);
    shown.scene.set_field(field, 0.5);
    const Vec3 middle = physical_centre(field.geometry());
    const RayHit hit = cast_ray(field, 0.5, middle + Vec3(3, -24, 5), middle);
    ASSERT_TRUE(hit.hit);
    Camera camera = from_front(field, 2);
    camera.focus = hit.point;
    shown.scene.set_camera(camera);
    Snapshot snapshot = snapshot_at(hit.point, hit.point);
    snapshot.scp = locate(index_from_physical(field.geometry(), hit.point));
    snapshot.session.tick.proxy.isovalue = 0.5;
    shown.scene.show_snapshot(snapshot);
    const QImage without = shown.settled();
    look.tetrahedra = true;
    set(shown.scene, &Shown::look, look);
    const QImage tetrahedra = shown.settled("tetrahedra");
    const auto is_patch = [](QRgb p) { return qRed(p) > qBlue(p) + 60; };
    EXPECT_EQ(blob(without, is_patch).count, 0);
    EXPECT_GT(blob(tetrahedra, is_patch).count, 150);
    look.planes = true;
    set(shown.scene, &Shown::look, look);
    EXPECT_GT(difference(shown.settled("planes"), tetrahedra), 1);
}

}  // namespace
}  // namespace palpate::viewer
