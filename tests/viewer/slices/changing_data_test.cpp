// Slices of changing data: edited, or between two frames.
#include <gtest/gtest.h>

#include "apps/viewer/slices/samples.hpp"
#include "palpate/edit.hpp"
#include "support/fields.hpp"
#include "viewer/slices/pane_support.hpp"

namespace palpate::viewer {
namespace {

Field flat(const Field& field) {
    return linear_field(flattened(field.samples(), field.moment()), field.solid(),
                        field.background());
}

Field carved(const Field& field, const Vec3& at, double radius) {
    edit::Stroke stroke;
    stroke.brush = brush_for(BrushKind::carve, field, 0.5, radius);
    stroke.from = stroke.to = at;
    Field now = field;
    now.use(edited(field.shared_samples(), stroke).samples);
    return now;
}

Field moving_ball(const Mat3& direction) {
    const Field first = ball_on(direction);
    const Geometry& g = first.geometry();
    const Volume later = support::volume_of<float>(g, [&](const Index3& i) {
        const Vec3 p = physical_from_index(g, i.cast<double>()) - Vec3(9, 4, 2);
        return 0.5 + 0.1 * (12 - p.norm());
    });
    std::vector<Frame> frames{{0, first.volume()}, {2, later}};
    return linear_field(std::make_shared<const Samples>(std::move(frames)), first.solid(),
                        first.background());
}

void expect_same(const SliceSamples& a, const SliceSamples& b, double within) {
    for (const int layer : {0, 1}) {
        for (int v = -1; v <= a.height(); ++v) {
            for (int u = -1; u <= a.width(); ++u) {
                ASSERT_NEAR(a.row(layer, v)[u], b.row(layer, v)[u], within) << u << ' ' << v;
            }
        }
    }
}

TEST(ChangingSlices, samples_are_the_edited_ones_and_those_of_the_moment) {
    for (const Mat3& direction : {Mat3(Mat3::Identity()), support::oblique_direction()}) {
        const Field before = ball_on(direction);
        const Field edited_ball = carved(before, {3, -2, 16}, 6);
        Field between = moving_ball(direction);
        between.set_time(0.7);
        Field at_frame = between;
        at_frame.set_time(2);
        for (const Field& now : {edited_ball, between, at_frame}) {
            for (int axis = 0; axis < 3; ++axis) {
                const SlicePlane plane = slice_plane(now.geometry(), axis);
                SliceSamples samples(before, plane), expected(flat(now), plane);
                const double position = 0.6 * now.geometry().size[axis] + 0.25;
                samples.go_to(position);
                samples.use(now);
                EXPECT_EQ(samples.position(), position);
                expected.go_to(position);
                expect_same(samples, expected, 1e-6);
            }
        }
    }
}

/// Once the pane has caught up.
QImage picture_of(ShownPane& shown) {
    // Which of two windows has the focus is not what is compared.
    shown.pane.setFocusPolicy(Qt::NoFocus);
    shown.pane.clearFocus();
    return shown.picture();
}

TEST(ChangingSlices, a_pane_shows_the_newest_of_many_versions_as_if_it_had_been_opened) {
    Field field = ball_on(Mat3::Identity());
    ShownPane shown(2, field);
    shown.pane.set_window(0, 1);
    shown.pane.set_crosshair({3, 4, 1.25});
    shown.wheel({150, 170}, 240, Qt::ControlModifier);  // a view of its own
    const QImage before = picture_of(shown);
    const Vec3 crosshair = shown.pane.crosshair();
    for (int i = 0; i < 30; ++i) {
        field = carved(field, {20 - 0.5 * i, 0.3 * i, 0}, 5);
        shown.pane.update_field(field);
        handle_events();
    }
    const QImage after = picture_of(shown);
    keep_picture(shown.pane, "carved_slice");
    EXPECT_NE(after, before);
    EXPECT_EQ(shown.pane.crosshair(), crosshair);

    ShownPane fresh(2, flat(field));
    fresh.pane.set_window(0, 1);
    fresh.pane.set_crosshair({3, 4, 1.25});
    fresh.wheel({150, 170}, 240, Qt::ControlModifier);
    EXPECT_EQ(after, picture_of(fresh));
    // And back: undone.
    shown.pane.update_field(ball_on(Mat3::Identity()));
    EXPECT_EQ(picture_of(shown), before);
}

TEST(ChangingSlices, a_pane_follows_the_moment) {
    Field field = moving_ball(Mat3::Identity());
    ShownPane shown(1, field);
    shown.pane.set_window(0, 1);
    for (const double time : {0.4, 1.1, 1.5}) {
        field.set_time(time);
        shown.pane.update_field(field);
    }
    ShownPane fresh(1, flat(field));
    fresh.pane.set_window(0, 1);
    EXPECT_EQ(picture_of(shown), picture_of(fresh));
    keep_picture(shown.pane, "between_frames_slice");
}

TEST(ChangingSlices, another_grid_is_no_version) {
    ShownPane shown(0);
    const Field field = ball_on(Mat3::Identity());
    EXPECT_THROW(shown.pane.update_field(field), std::invalid_argument);
    shown.pane.set_field(field, 0.5);
    EXPECT_THROW(shown.pane.update_field(ball_on(Mat3::Identity(), {1, 1, 1})),
                 std::invalid_argument);
}

}  // namespace
}  // namespace palpate::viewer
