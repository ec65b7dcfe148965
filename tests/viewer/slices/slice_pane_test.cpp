// Slice panes, used by mouse and keys.
#include "apps/viewer/slices/slice_pane.hpp"

#include "apps/viewer/slices/slice_picture.hpp"
#include "support/fields.hpp"
#include "viewer/slices/pane_support.hpp"

namespace palpate::viewer {
namespace {

using support::oblique_direction;

Mat3 mirrored() {
    return Vec3(-1, 1, -1).asDiagonal();
}

double distance(const QPointF& a, const QPointF& b) {
    return std::hypot(a.x() - b.x(), a.y() - b.y());
}

TEST(SlicePane, a_click_puts_the_crosshair_where_it_is) {
    for (const Mat3& direction : {Mat3(Mat3::Identity()), mirrored(), oblique_direction()}) {
        for (int axis = 0; axis < 3; ++axis) {
            ShownPane shown(axis, ball_on(direction));
            const QPoint at(230, 150);
            const Vec3 expected = shown.pane.point_at(at);
            QTest::mouseClick(&shown.pane, Qt::LeftButton, Qt::NoModifier, at);
            ASSERT_EQ(shown.chosen.size(), 1U);
            EXPECT_LT((shown.chosen[0] - expected).norm(), 1e-9);
            EXPECT_EQ(shown.pane.shown().crosshair, shown.chosen[0]);
            EXPECT_LT(distance(shown.pane.pixel_of(shown.chosen[0]), at), 1e-6);
            EXPECT_TRUE(shown.aimed.empty());
        }
    }
}

TEST(SlicePane, a_click_beside_the_data_goes_to_their_border) {
    ShownPane shown(2, ball_on(Mat3::Identity()));
    QTest::mouseClick(&shown.pane, Qt::LeftButton, Qt::NoModifier, {2, 180});
    ASSERT_EQ(shown.chosen.size(), 1U);
    EXPECT_NEAR(shown.chosen[0][0], -23.5, 1e-9);
}

TEST(SlicePane, as_a_hand_it_aims_the_probe_with_ctrl_only) {
    ShownPane shown(2, ball_on(oblique_direction()));
    set(shown.pane, &Shown::probe, true);
    const Vec3 before = shown.pane.shown().crosshair;
    shown.drag(Qt::LeftButton, {150, 150}, {250, 190}, Qt::ControlModifier);
    ASSERT_EQ(shown.aimed.size(), 1U);
    const Vec3 from = shown.pane.point_at(QPointF(150, 150));
    EXPECT_LT((shown.aimed[0] - from).norm(), 1e-9);
    ASSERT_EQ(shown.dragged.size(), 1U);
    EXPECT_LT((from + shown.dragged[0] - shown.pane.point_at(QPointF(250, 190))).norm(), 1e-9);
    EXPECT_EQ(shown.pane.shown().crosshair, before);
    EXPECT_TRUE(shown.chosen.empty());
    shown.drag(Qt::LeftButton, {150, 150}, {250, 190});
    QTest::mouseClick(&shown.pane, Qt::LeftButton, Qt::NoModifier, {200, 180});
    QTest::mouseDClick(&shown.pane, Qt::LeftButton, Qt::ShiftModifier, {200, 180});
    EXPECT_EQ(shown.aimed.size() + shown.dragged.size(), 2U);
    EXPECT_EQ(shown.chosen.size(), 3U);
}

TEST(SlicePane, the_probe_stays_in_its_slice_while_it_is_dragged_and_the_wheel_moves_it_in_depth) {
    ShownPane shown(2, ball_on(Mat3::Identity()));
    set(shown.pane, &Shown::probe, true);
    set(shown.pane, &Shown::crosshair, {0, 0, 3});
    QTest::mousePress(&shown.pane, Qt::LeftButton, Qt::ControlModifier, {200, 180});
    set(shown.pane, &Shown::crosshair, {0, 0, 4.2});  // the probe was pushed back
    QMouseEvent move(QEvent::MouseMove, QPointF(210, 180), Qt::NoButton, Qt::LeftButton,
                     Qt::NoModifier);
    QApplication::sendEvent(&shown.pane, &move);
    ASSERT_EQ(shown.dragged.size(), 1U);
    EXPECT_NEAR(shown.aimed.at(0)[2], 3, 1e-9);
    EXPECT_NEAR(shown.dragged[0][2], 0, 1e-9);
    shown.wheel({210, 180}, 120);
    ASSERT_EQ(shown.dragged.size(), 2U);
    EXPECT_NEAR(shown.dragged[1][2], 1.5, 1e-9);  // a layer
    EXPECT_TRUE(shown.chosen.empty());
    QTest::mouseRelease(&shown.pane, Qt::LeftButton, Qt::NoModifier, {210, 180});
}

TEST(SlicePane, the_wheel_goes_layer_by_layer_up_to_the_head_and_stops_at_the_end) {
    for (const Mat3& direction : {Mat3(Mat3::Identity()), mirrored()}) {
        ShownPane shown(2, ball_on(direction));
        set(shown.pane, &Shown::crosshair, {1, 2, 0.4});
        shown.wheel({200, 180}, 120);
        ASSERT_EQ(shown.chosen.size(), 1U);
        EXPECT_NEAR(shown.chosen[0][2], 1.5, 1e-9);
        EXPECT_NEAR(shown.chosen[0][0], 1, 1e-9);
        shown.wheel({200, 180}, -120);
        shown.wheel({200, 180}, -120);
        EXPECT_NEAR(shown.chosen.back()[2], -1.5, 1e-9);
        shown.wheel({200, 180}, 60);  // a touch pad turns by less than a step
        shown.wheel({200, 180}, 60);
        EXPECT_NEAR(shown.chosen.back()[2], 0, 1e-9);
        shown.wheel({200, 180}, 120 * 100);
        EXPECT_NEAR(shown.chosen.back()[2], 24, 1e-9);
    }
}

TEST(SlicePane, zooming_keeps_what_is_under_the_pointer_and_a_double_click_shows_all_again) {
    ShownPane shown(1, ball_on(oblique_direction()));
    const QPoint at(120, 90);
    const Vec3 before = shown.pane.point_at(at), corner = shown.pane.point_at(QPointF(0, 0));
    shown.wheel(at, 360, Qt::ControlModifier);
    EXPECT_LT((shown.pane.point_at(at) - before).norm(), 1e-9);
    EXPECT_GT((shown.pane.point_at(QPointF(0, 0)) - corner).norm(), 3);
    EXPECT_TRUE(shown.chosen.empty());
    QTest::mouseDClick(&shown.pane, Qt::LeftButton, Qt::ShiftModifier, at);
    EXPECT_LT((shown.pane.point_at(QPointF(0, 0)) - corner).norm(), 1e-9);
}

TEST(SlicePane, the_middle_button_moves_the_picture_with_the_pointer) {
    ShownPane shown(0, ball_on(mirrored()));
    const Vec3 before = shown.pane.point_at(QPointF(100, 100));
    shown.drag(Qt::MiddleButton, {100, 100}, {160, 130});
    EXPECT_LT((shown.pane.point_at(QPointF(160, 130)) - before).norm(), 1e-9);
    EXPECT_TRUE(shown.chosen.empty());
}

TEST(SlicePane, the_right_button_changes_grey_levels_and_a_double_click_brings_the_first_back) {
    ShownPane shown(2, ball_on(Mat3::Identity()));
    set(shown.pane, &Shown::usual_window, {0.25, 0.75});
    shown.drag(Qt::RightButton, {100, 100}, {140, 100});  // a tenth of the width: of the range
    EXPECT_NEAR(shown.pane.grey_window().high - shown.pane.grey_window().low, 0.6, 0.01);
    EXPECT_NEAR(shown.pane.grey_window().high + shown.pane.grey_window().low, 1, 1e-9);
    ASSERT_EQ(shown.windows.size(), 1U);
    EXPECT_EQ(shown.windows[0].low, shown.pane.grey_window().low);
    shown.drag(Qt::RightButton, {100, 100}, {-4000, 60});
    EXPECT_LT(shown.pane.grey_window().low, shown.pane.grey_window().high);
    const double high = shown.pane.grey_window().high;
    for (const auto button : {Qt::RightButton, Qt::MiddleButton}) {
        QTest::mouseDClick(&shown.pane, button, Qt::NoModifier, {10, 10});
        QTest::mouseRelease(&shown.pane, button, Qt::NoModifier, {10, 10});
        EXPECT_EQ(shown.pane.grey_window().high, high) << "the next of two quick drags";
    }
    QTest::mouseDClick(&shown.pane, Qt::LeftButton, Qt::ShiftModifier, {10, 10});
    EXPECT_EQ(shown.pane.grey_window().low, 0.25);
    EXPECT_EQ(shown.pane.grey_window().high, 0.75);
}

TEST(SlicePane, keys_do_what_the_mouse_does) {
    ShownPane shown(2, ball_on(Mat3::Identity()));
    set(shown.pane, &Shown::crosshair, {0.5, 0, 0});
    QTest::keyClick(&shown.pane, Qt::Key_Right);
    EXPECT_NEAR(shown.pane.shown().crosshair[0], 1.5, 1e-9);
    QTest::keyClick(&shown.pane, Qt::Key_Down);
    EXPECT_NEAR(shown.pane.shown().crosshair[1], 1.25, 1e-9);
    QTest::keyClick(&shown.pane, Qt::Key_PageUp);
    EXPECT_NEAR(shown.pane.shown().crosshair[2], 1.5, 1e-9);
    EXPECT_EQ(shown.chosen.size(), 3U);
    const Vec3 corner = shown.pane.point_at(QPointF(0, 0));
    QTest::keyClick(&shown.pane, Qt::Key_Plus);
    EXPECT_GT((shown.pane.point_at(QPointF(0, 0)) - corner).norm(), 1);
    QTest::keyClick(&shown.pane, Qt::Key_Home);
    EXPECT_LT((shown.pane.point_at(QPointF(0, 0)) - corner).norm(), 1e-9);
}

TEST(SlicePane, a_millimetre_is_as_many_pixels_in_every_direction) {
    ShownPane shown(1, ball_on(oblique_direction(), {0.5, 1, 3}));
    const Geometry geometry = ball_on(oblique_direction(), {0.5, 1, 3}).geometry();
    const Vec3 origin = Vec3::Zero();
    const double one = distance(shown.pane.pixel_of(origin),
                                shown.pane.pixel_of(physical_from_grid_axes(geometry, {1, 0, 0})));
    const double two = distance(shown.pane.pixel_of(origin),
                                shown.pane.pixel_of(physical_from_grid_axes(geometry, {0, 0, 1})));
    EXPECT_NEAR(one, two, 1e-9);
    EXPECT_GT(one, 1);
}

/// The colour nearest to orange among a pixel and those beside it: a line may lie between two.
QColor nearest_to_orange(const QImage& picture, const QPoint& at) {
    QColor nearest = picture.pixel(at);
    for (const QPoint& by : {QPoint(1, 0), QPoint(-1, 0), QPoint(0, 1), QPoint(0, -1)}) {
        const QColor one = picture.pixel(at + by);
        if (one.red() - one.blue() > nearest.red() - nearest.blue()) nearest = one;
    }
    return nearest;
}

TEST(SlicePane, grey_levels_run_from_low_to_high_and_the_contour_is_on_the_surface) {
    const Field field = ball_on(oblique_direction());
    // The lattice's field and a linear one differ a little between samples.
    for (int axis = 0; axis < 3; ++axis) {
        ShownPane shown(axis, field);
        set(shown.pane, &Shown::window, {0, 2});
        const QImage picture = shown.picture();
        // In the middle of the ball, beside the crosshair.
        const QPoint inside = (shown.pane.pixel_of(Vec3::Zero()) + QPointF(20, 20)).toPoint();
        const double value = value_at(field, shown.pane.point_at(inside + QPointF(0.5, 0.5)));
        EXPECT_NEAR(qGreen(picture.pixel(inside)), 255 * value / 2, 4);
        EXPECT_GT(value, 0.6);
        const Vec3 along = field.geometry().direction.col((axis + 1) % 3) +
                           0.3 * field.geometry().direction.col((axis + 2) % 3);
        const RayHit hit = cast_ray(field, 0.5, 24 * along.normalized(), Vec3::Zero());
        ASSERT_TRUE(hit.hit);
        const QColor there = nearest_to_orange(picture, shown.pane.pixel_of(hit.point).toPoint());
        EXPECT_NEAR(there.red(), contour_colour().red(), 60);
        EXPECT_GT(there.red() - there.blue(), 100);
    }
}

TEST(SlicePane, without_a_surface_at_the_level_nothing_is_orange) {
    ShownPane shown(2, ball_on(Mat3::Identity()), 7);
    QImage picture = shown.picture();
    set(shown.pane, &Shown::isovalue, 0.5);
    const QImage contoured = shown.picture();
    EXPECT_NE(picture, contoured);
    set(shown.pane, &Shown::isovalue, 7);
    EXPECT_EQ(shown.picture(), picture);
}

TEST(SlicePane, hand_and_proxy_are_where_they_are_and_pale_where_they_are_off_the_slice) {
    ShownPane shown(2, ball_on(Mat3::Identity()), 7);
    set(shown.pane, &Shown::window, {-1, 0});  // all white
    const Vec3 hip(10, 10, 0), scp(12, 14, 0);
    const auto blueness = [&](const Vec3& at) {
        const QColor c = shown.picture().pixel(shown.pane.pixel_of(at).toPoint());
        return c.blue() - c.red();
    };
    EXPECT_LT(blueness(hip), 10);
    shown.pane.show_snapshot(contact_at(hip, scp, Vec3::Zero()));
    const int near = blueness(hip);
    EXPECT_GT(near, 120);
    const QColor proxy = shown.picture().pixel(shown.pane.pixel_of(scp).toPoint());
    EXPECT_GT(proxy.red() - proxy.blue(), 120);
    shown.pane.show_snapshot(contact_at(hip + Vec3(0, 0, 15), scp, Vec3::Zero()));
    EXPECT_LT(blueness(hip), near / 2);
    EXPECT_GT(blueness(hip), 10);
    shown.pane.show_snapshot({});
    EXPECT_LT(blueness(hip), 10);
}

TEST(SlicePane, a_second_hand_has_colours_of_its_own_and_both_have_their_numbers) {
    ShownPane shown(2, ball_on(Mat3::Identity()), 7);
    set(shown.pane, &Shown::window, {-1, 0});  // all white
    const Vec3 hip(10, 10, 0), scp(12, 14, 0), other_hip(-10, 10, 0), other_scp(-12, 14, 0);
    const auto colour_at = [&](const Vec3& at) {
        return QColor(shown.picture().pixel(shown.pane.pixel_of(at).toPoint()));
    };
    shown.pane.show_snapshot(contact_at(hip, scp, Vec3::Zero()));
    const QImage alone = shown.picture();
    const QColor first = colour_at(hip), proxy = colour_at(scp);
    shown.pane.show_snapshot(contact_at(other_hip, other_scp, Vec3::Zero()), 2);
    EXPECT_EQ(colour_at(hip), first);
    EXPECT_EQ(colour_at(scp), proxy);
    EXPECT_GT(colour_at(other_hip).blue() - colour_at(other_hip).red(), 90);
    EXPECT_GT(colour_at(other_hip).lightness(), first.lightness() + 40);
    EXPECT_GT(colour_at(other_scp).red() - colour_at(other_scp).blue(), 120);
    EXPECT_GT(colour_at(other_scp).green(), proxy.green() + 40);
    const QPoint beside = shown.pane.pixel_of(hip).toPoint();
    const QRect number(beside + QPoint(4, 0), QSize(16, 16));
    EXPECT_NE(shown.picture().copy(number), alone.copy(number));
    shown.pane.show_snapshot({}, 2);
    EXPECT_EQ(shown.picture(), alone);
}

TEST(SlicePane, the_force_points_where_it_points_in_space) {
    ShownPane shown(2, ball_on(mirrored()), 7);
    set(shown.pane, &Shown::window, {1, 2});  // all black
    Snapshot snapshot = contact_at({0, 12, 0}, {0, 10, 0}, Vec3(0, 0, 2));
    // Device z is the patient's front here: the force is to be drawn upwards.
    snapshot.session.transform.rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    shown.pane.show_snapshot(snapshot);
    const QPointF scp = shown.pane.pixel_of({0, 10, 0});
    const auto greenness = [&](const QPointF& at) {
        const QColor c = shown.picture().pixel(at.toPoint());
        return c.green() - c.red();
    };
    EXPECT_GT(greenness(scp - QPointF(0, 40)), 60);
    EXPECT_LT(greenness(scp + QPointF(0, 40)), 20);
}

TEST(SlicePane, the_same_samples_again_keep_the_view_and_others_do_not) {
    const Field field = ball_on(Mat3::Identity());
    ShownPane shown(2, field);
    shown.wheel({100, 100}, 240, Qt::ControlModifier);
    set(shown.pane, &Shown::window, {0.2, 0.4});
    set(shown.pane, &Shown::crosshair, {1, 2, 3});
    const Vec3 corner = shown.pane.point_at(QPointF(0, 0));
    shown.pane.set_field(linear_field(field.volume(), Solid::below), 0.5);
    EXPECT_EQ(shown.pane.point_at(QPointF(0, 0)), corner);
    EXPECT_EQ(shown.pane.grey_window().low, 0.2);
    EXPECT_EQ(shown.pane.shown().crosshair, Vec3(1, 2, 3));
    shown.pane.set_field(ball_on(Mat3::Identity()), 0.5);
    EXPECT_NE(shown.pane.point_at(QPointF(0, 0)), corner);
    EXPECT_NE(shown.pane.grey_window().low, 0.2);
}

TEST(SlicePane, however_fast_the_crosshair_moves_the_last_slice_is_shown) {
    const Field field = ball_on(oblique_direction());
    ShownPane moved(2, field), there(2, field);
    const Vec3 last = physical_from_index(field.geometry(), {30, 12, 20.3});
    set(there.pane, &Shown::crosshair, last);
    const QImage expected = there.picture();
    for (int i = 0; i < 50; ++i) {
        set(moved.pane, &Shown::crosshair,
            physical_from_index(field.geometry(), {30, 12, 5 + 0.31 * i}));
        moved.pane.grab();
    }
    set(moved.pane, &Shown::crosshair, last);
    EXPECT_EQ(moved.picture(), expected);
}

TEST(SlicePane, empty_or_emptied_in_the_middle_of_a_drag_it_takes_everything) {
    ShownPane shown(1);
    shown.picture();
    const auto play = [&] {
        shown.drag(Qt::LeftButton, {10, 10}, {50, 50});
        shown.drag(Qt::RightButton, {10, 10}, {50, 50});
        shown.wheel({10, 10}, 120);
        QTest::keyClick(&shown.pane, Qt::Key_Up);
        QTest::mouseDClick(&shown.pane, Qt::LeftButton, Qt::ShiftModifier);
        set(shown.pane, &Shown::crosshair, {1, 2, 3});
        set(shown.pane, &Shown::isovalue, 3);
        shown.pane.show_snapshot(contact_at({1, 2, 3}, {4, 5, 6}, {1, 1, 1}));
        shown.picture();
    };
    play();
    EXPECT_TRUE(shown.chosen.empty() && shown.aimed.empty() && shown.windows.empty());
    shown.pane.set_field(ball_on(Mat3::Identity()), 0.5);
    QTest::mousePress(&shown.pane, Qt::LeftButton, Qt::NoModifier, {100, 100});
    shown.pane.clear();
    QMouseEvent move(QEvent::MouseMove, QPointF(210, 180), Qt::NoButton, Qt::LeftButton,
                     Qt::NoModifier);
    QApplication::sendEvent(&shown.pane, &move);
    play();
    EXPECT_EQ(shown.chosen.size(), 1U);
}

TEST(SlicePane, odd_sizes_and_places_do_no_harm) {
    ShownPane shown(2, ball_on(oblique_direction()));
    for (const QSize& size : {QSize(1, 1), QSize(700, 40), QSize(3, 500)}) {
        shown.pane.setMinimumSize(1, 1);
        shown.pane.resize(size);
        shown.picture();
    }
    for (const Vec3& far : {Vec3(1e9, 0, 0), Vec3(-1e300, 1e300, 5), Vec3(0, 0, 1e5)}) {
        set(shown.pane, &Shown::crosshair, far);
        shown.pane.show_snapshot(contact_at(far, Vec3::Zero(), Vec3(1, 0, 0)));
        shown.picture();
    }
    const Vec3 before = shown.pane.shown().crosshair;
    set(shown.pane, &Shown::crosshair, {0, std::nan(""), 0});
    EXPECT_EQ(shown.pane.shown().crosshair, before);
    for (int i = 0; i < 40; ++i) shown.wheel({1, 30}, 120, Qt::ControlModifier);
    shown.picture();
    for (int i = 0; i < 80; ++i) shown.wheel({1, 30}, -120, Qt::ControlModifier);
    shown.picture();
    ShownPane single(0, linear_field(support::volume_of<float>(support::grid({1, 1, 1}),
                                                               [](const Index3&) { return 5; })));
    single.picture();
}

TEST(SlicePane, the_crosshair_leaves_room_for_words) {
    Geometry geometry = scenes::centred({48, 40, 33}, {1, 1.25, 1.5}, Mat3::Identity());
    geometry.origin += Vec3(120, 120, 120);  // long numbers
    ShownPane shown(
        2, linear_field(scenes::make_volume("sphere", geometry, SampleType::float32).volume));
    const int line = shown.pane.fontMetrics().height();
    shown.pane.resize(7 * line, 24 * line);
    const QImage image = shown.picture();
    keep_picture(shown.pane, "narrow_pane");
    const double scale = image.devicePixelRatio();
    const int x = static_cast<int>(shown.pane.pixel_of(shown.pane.shown().crosshair).x() * scale);
    const auto yellow = [&](double y) {
        const QRgb colour = image.pixel(x, static_cast<int>(y * scale));
        return qRed(colour) - qBlue(colour) > 60;
    };
    EXPECT_TRUE(yellow(6 * line)) << "the line is there";
    // Title, count and position have a line each.
    for (double y = 0.4 * line; y < 3.2 * line; ++y) EXPECT_FALSE(yellow(y)) << y / line;
}

}  // namespace
}  // namespace palpate::viewer
