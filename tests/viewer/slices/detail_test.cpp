// Slices of changing data, and a finer part of a slice, drawn in its place.
#include <gtest/gtest.h>

#include <random>

#include "apps/viewer/slices/samples.hpp"
#include "palpate/edit.hpp"
#include "support/edits.hpp"
#include "support/fields.hpp"
#include "support/parameter.hpp"
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
    set(shown.pane, &Shown::window, {0, 1});
    set(shown.pane, &Shown::crosshair, {3, 4, 1.25});
    shown.wheel({150, 170}, 240, Qt::ControlModifier);  // a view of its own
    const QImage before = picture_of(shown);
    const Vec3 crosshair = shown.pane.shown().crosshair;
    for (int i = 0; i < 30; ++i) {
        field = carved(field, {20 - 0.5 * i, 0.3 * i, 0}, 5);
        shown.pane.update_field(field);
        handle_events();
    }
    const QImage after = picture_of(shown);
    keep_picture(shown.pane, "carved_slice");
    EXPECT_NE(after, before);
    EXPECT_EQ(shown.pane.shown().crosshair, crosshair);

    ShownPane fresh(2, flat(field));
    set(fresh.pane, &Shown::window, {0, 1});
    set(fresh.pane, &Shown::crosshair, {3, 4, 1.25});
    fresh.wheel({150, 170}, 240, Qt::ControlModifier);
    EXPECT_EQ(after, picture_of(fresh));
    // And back: undone.
    shown.pane.update_field(ball_on(Mat3::Identity()));
    EXPECT_EQ(picture_of(shown), before);
}

TEST(ChangingSlices, a_pane_follows_the_moment) {
    Field field = moving_ball(Mat3::Identity());
    ShownPane shown(1, field);
    set(shown.pane, &Shown::window, {0, 1});
    for (const double time : {0.4, 1.1, 1.5}) {
        field.set_time(time);
        shown.pane.update_field(field);
    }
    ShownPane fresh(1, flat(field));
    set(fresh.pane, &Shown::window, {0, 1});
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

/// Smooth, so that the contour is a line, not a cloud.
Volume hills(const Geometry& geometry) {
    std::vector<float> samples;
    for (int k = 0; k < geometry.size[2]; ++k) {
        for (int j = 0; j < geometry.size[1]; ++j) {
            for (int i = 0; i < geometry.size[0]; ++i) {
                const Vec3 at = physical_from_index(geometry, Vec3(i, j, k));
                samples.push_back(static_cast<float>(
                    std::sin(0.31 * at[0]) + std::cos(0.23 * at[1]) + std::sin(0.27 * at[2])));
            }
        }
    }
    return {geometry, std::move(samples)};
}

struct Levels {
    Geometry fine = scenes::centred({64, 56, 48}, {1, 1.25, 1.5}, Mat3::Identity());
    Geometry coarse = fine;
    Interpolation way;

    explicit Levels(Interpolation interpolation) : way(interpolation) {
        coarse.size /= 2;
        coarse.origin = physical_from_index(fine, Vec3::Constant(0.5));
        coarse.spacing *= 2;
    }
    Field field(const Geometry& geometry) const {
        return Field(hills(geometry), Solid::above, -3.0, way);
    }
    std::shared_ptr<const DetailField> detail(const SampleBox& box) const {
        Geometry part = fine;
        part.origin = physical_from_index(fine, box.low.cast<double>());
        part.size = box.high - box.low + Index3::Ones();
        return std::make_shared<const DetailField>(DetailField{field(part), {0, box}, fine.size});
    }
};

int differing(const QImage& a, const QImage& b, const QRect& part) {
    int count = 0;
    for (int y = part.top(); y <= part.bottom(); ++y) {
        for (int x = part.left(); x <= part.right(); ++x) count += a.pixel(x, y) != b.pixel(x, y);
    }
    return count;
}

class SliceDetail : public testing::TestWithParam<Interpolation> {};

TEST_P(SliceDetail, all_of_a_level_looks_like_the_volume_itself) {
    const Levels levels(GetParam());
    for (int axis = 0; axis < 3; ++axis) {
        ShownPane whole(axis, levels.field(levels.fine), 0.3), store(axis);
        store.pane.set_field(levels.field(levels.coarse), 0.3, levels.fine);
        for (SlicePane* pane : {&whole.pane, &store.pane}) set(*pane, &Shown::window, {-3, 3});
        EXPECT_GT(differing(whole.picture(), store.picture(), whole.pane.rect()), 3000);
        store.pane.set_detail(levels.detail(whole_box(levels.fine)));
        for (const double part : {0.0, 0.3, 0.52, 1.0}) {
            Vec3 index = 0.5 * (levels.fine.size - Index3::Ones()).cast<double>();
            index[axis] = std::round(part * (levels.fine.size[axis] - 1));
            for (SlicePane* pane : {&whole.pane, &store.pane}) {
                set(*pane, &Shown::crosshair, physical_from_index(levels.fine, index));
            }
            EXPECT_LE(differing(whole.picture(), store.picture(), whole.pane.rect()), 40)
                << axis << ' ' << part;
        }
    }
}

TEST_P(SliceDetail, a_part_is_finer_there_and_changes_nothing_elsewhere) {
    const Levels levels(GetParam());
    ShownPane whole(2, levels.field(levels.fine), 0.3), store(2);
    store.pane.set_field(levels.field(levels.coarse), 0.3, levels.fine);
    for (SlicePane* pane : {&whole.pane, &store.pane}) set(*pane, &Shown::window, {-3, 3});
    const QImage fine = whole.picture(), coarse = store.picture();
    const SampleBox box{{10, 12, 18}, {50, 40, 28}};
    store.pane.set_detail(levels.detail(box));
    const QImage both = store.picture();
    ASSERT_NE(store.pane.shown_detail(), nullptr);
    const auto pixel = [&](const Index3& at) {
        return store.pane.pixel_of(physical_from_index(levels.fine, at.cast<double>())).toPoint();
    };
    const QRect outer = QRect(pixel(box.low), pixel(box.high)).normalized();
    const QRect inner =
        QRect(pixel(box.low + Index3::Constant(3)), pixel(box.high - Index3::Constant(3)))
            .normalized();
    EXPECT_LE(differing(both, fine, inner), inner.width() * inner.height() / 100);
    EXPECT_GT(differing(both, coarse, inner), inner.width() * inner.height() / 4);
    const QRect all = store.pane.rect();
    EXPECT_EQ(differing(both, coarse, {0, 0, all.width(), outer.top() - 2}), 0);
    EXPECT_EQ(differing(both, coarse, {0, 0, outer.left() - 2, all.height()}), 0);
    EXPECT_EQ(differing(both, coarse,
                        {outer.right() + 2, 0, all.width() - outer.right() - 2, all.height()}),
              0);
    keep_picture(store.pane, "a-part-of-a-slice-is-finer");
}

TEST_P(SliceDetail, a_slice_that_has_left_the_part_shows_the_overview) {
    const Levels levels(GetParam());
    ShownPane store(2);
    store.pane.set_field(levels.field(levels.coarse), 0.3, levels.fine);
    const auto at = [&](double layer) {
        set(store.pane, &Shown::crosshair, physical_from_index(levels.fine, Vec3(30, 30, layer)));
        return store.picture();
    };
    const QImage coarse = at(30), coarse_end = at(47);
    store.pane.set_detail(levels.detail({{0, 0, 18}, {63, 55, 28}}));
    EXPECT_EQ(at(30), coarse);
    EXPECT_EQ(store.pane.shown_detail(), nullptr);
    (void)at(23.5);
    EXPECT_NE(store.pane.shown_detail(), nullptr);
    // Up to the end of the data, and beyond, where the part ends with them.
    store.pane.set_detail(levels.detail({{0, 0, 40}, {63, 55, 47}}));
    EXPECT_NE(at(47), coarse_end);
    EXPECT_NE(store.pane.shown_detail(), nullptr);
    store.pane.set_detail(nullptr);
    EXPECT_EQ(at(47), coarse_end);
}

TEST_P(SliceDetail, slices_are_counted_in_the_level_that_is_felt_and_stepped_as_they_are_shown) {
    const Levels levels(GetParam());
    ShownPane store(2);
    store.pane.set_field(levels.field(levels.coarse), 0.3, levels.fine);
    set(store.pane, &Shown::crosshair, physical_from_index(levels.fine, Vec3(30, 30, 20)));
    const auto layer = [&] {
        return index_from_physical(levels.fine, store.pane.shown().crosshair)[2];
    };
    (void)store.picture();
    store.wheel({200, 180}, 120);
    EXPECT_NEAR(layer(), 22, 1e-9) << "a sample of the overview";
    store.pane.set_detail(levels.detail({{0, 0, 18}, {63, 55, 28}}));
    (void)store.picture();
    store.wheel({200, 180}, 120);
    EXPECT_NEAR(layer(), 23, 1e-9);
}

TEST(SeenSlice, a_pane_tells_what_it_shows) {
    const Levels levels(Interpolation::linear);
    SlicePane hidden(1);
    hidden.set_field(levels.field(levels.coarse), 0.3, levels.fine);
    EXPECT_FALSE(hidden.seen()) << "a pane that is not shown needs nothing";
    ShownPane store(1);
    EXPECT_FALSE(store.pane.seen());
    store.pane.set_field(levels.field(levels.coarse), 0.3, levels.fine);
    const auto seen = store.pane.seen();
    ASSERT_TRUE(seen);
    const Vec3 low = seen->from.cwiseMin(seen->to), high = seen->from.cwiseMax(seen->to);
    const Vec3 first = physical_from_index(levels.fine, Vec3::Zero());
    EXPECT_NEAR(low[0], first[0], 1e-9) << "not beyond the data";
    EXPECT_NEAR(high[2], -first[2], 1e-9);
    EXPECT_NEAR(low[1], high[1], 1e-9);
    for (int i = 0; i < 12; ++i) store.wheel({200, 180}, 120, Qt::ControlModifier);
    const auto near = store.pane.seen();
    EXPECT_LT(near->pixel_mm, 0.3 * seen->pixel_mm);
    EXPECT_LT((near->from - near->to).norm(), 0.5 * (seen->from - seen->to).norm());
}

INSTANTIATE_TEST_SUITE_P(Fields, SliceDetail,
                         testing::Values(Interpolation::linear, Interpolation::cubic));

}  // namespace
}  // namespace palpate::viewer
