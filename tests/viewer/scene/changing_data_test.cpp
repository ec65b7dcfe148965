// The 3-D view of changing data: in the end it shows what a scene shows that was given the final
// data.
#include <gtest/gtest.h>

#include "apps/viewer/scene/scene.hpp"
#include "palpate/edit.hpp"
#include "palpate/scenes/volumes.hpp"
#include "support/fields.hpp"
#include "viewer/scene/shown_scene.hpp"

namespace palpate::viewer {
namespace {

Field flat(const Field& field) {
    return linear_field(flattened(field.samples(), field.moment()), field.solid(),
                        field.background());
}

/// A ball with a hole from a brush of `radius`, at a place on its upper half.
Edited dab(const Field& field, double level, double azimuth, double radius) {
    const Geometry& g = field.geometry();
    const double from_middle = 0.35 * g.size.minCoeff() * g.spacing.minCoeff();
    edit::Stroke stroke;
    stroke.brush = brush_for(BrushKind::carve, field, level, radius);
    stroke.from = stroke.to = physical_centre(g) + from_middle * Vec3(0.9 * std::cos(azimuth), -0.2,
                                                                      0.9 * std::sin(azimuth));
    return edited(field.shared_samples(), stroke);
}

Look surface_alone() {
    return bare();
}

Look volume_alone() {
    Look look = bare();
    look.surface = false;
    look.volume = true;
    look.transfer.points = {{80, pictures::bone, 0}, {160, pictures::bone, 0.8}};
    return look;
}

Look slices_alone() {
    Look look = bare();
    look.surface = false;
    look.slices = true;
    return look;
}

void open(ShownScene& shown, const Field& field, const Look& look) {
    set(shown.scene, &Shown::look, look);
    shown.scene.set_field(field, 128);
    shown.scene.look_from(pictures::view_named("front"));
}

QImage picture_of(const Field& field, const Look& look) {
    ShownScene shown;
    open(shown, field, look);
    return shown.settled();
}

/// Two sequences in one: frame 0 is the ball, frame 1 a smaller one beside its middle.
Field beating(int edge) {
    const Volume first = scenes::ball(support::cube(edge));
    const Geometry& g = first.geometry();
    const Volume second = support::volume_of<std::uint8_t>(g, [&](const Index3& i) {
        const Vec3 p = i.cast<double>() - Vec3::Constant(0.45 * edge);
        return std::clamp(128 + 20 * (0.25 * edge - p.norm()), 0.0, 255.0);
    });
    std::vector<Frame> frames{{0, first}, {1, second}};
    return linear_field(std::make_shared<const Samples>(std::move(frames), 2));
}

TEST(DrawnChangingScene, after_edits_surface_volume_and_slices_are_those_of_the_flattened_volume) {
    int number = 0;
    for (const Look& look : {surface_alone(), volume_alone(), slices_alone()}) {
        Field field = linear_field(scenes::ball(support::cube(80)));
        ShownScene shown;
        open(shown, field, look);
        const QImage before = shown.settled();
        for (int i = 0; i < 4; ++i) {
            const Edited after = dab(field, 128, 0.9 * i, 9);
            field.use(after.samples);
            shown.scene.update_field(field);
            shown.next_frame();
        }
        const std::string name = "edited_" + std::to_string(number++);
        const QImage after = shown.settled(name);
        EXPECT_GT(difference(before, after), 0.05) << name;
        EXPECT_LT(difference(picture_of(flat(field), look), after), 0.01) << name;
    }
}

TEST(DrawnChangingScene, an_edit_while_the_first_surface_is_under_way_is_there_in_the_end) {
    Field field = linear_field(scenes::ball(support::cube(150)));
    ShownScene shown;
    open(shown, field, surface_alone());
    for (int i = 0; i < 12; ++i) {
        field.use(dab(field, 128, 0.5 * i, 12).samples);
        shown.scene.update_field(field);
        if (i > 5) shown.next_frame();  // while it is coarse, and while it is fine
    }
    const QImage after = shown.settled("edited_meanwhile");
    EXPECT_LT(difference(picture_of(flat(field), surface_alone()), after), 0.01);
}

TEST(DrawnChangingScene, edits_and_levels_in_turns_end_with_the_last_of_both) {
    Field field = linear_field(scenes::ball(support::cube(90)));
    ShownScene shown;
    open(shown, field, surface_alone());
    for (int i = 0; i < 8; ++i) {
        field.use(dab(field, 128, 0.8 * i, 8).samples);
        shown.scene.update_field(field);
        set(shown.scene, &Shown::isovalue, 60 + 15 * i);
        for (int j = 0; j < i % 3; ++j) shown.next_frame();
    }
    const QImage after = shown.settled();
    ShownScene fresh;
    open(fresh, flat(field), surface_alone());
    set(fresh.scene, &Shown::isovalue, 165);
    EXPECT_LT(difference(fresh.settled(), after), 0.01);
}

TEST(DrawnChangingScene, undoing_an_edit_shows_the_volume_as_before) {
    const Field field = linear_field(scenes::ball(support::cube(64)));
    ShownScene shown;
    open(shown, field, surface_alone());
    const QImage before = shown.settled();
    Field now = field;
    now.use(dab(field, 128, 1, 12).samples);
    shown.scene.update_field(now);
    EXPECT_GT(difference(before, shown.settled()), 0.05);
    shown.scene.update_field(field);
    EXPECT_EQ(difference(before, shown.settled()), 0);
}

TEST(DrawnChangingScene, a_sequence_that_has_played_stands_at_its_last_moment) {
    for (const Look& look : {surface_alone(), volume_alone(), slices_alone()}) {
        Field field = beating(80);
        ShownScene shown;
        open(shown, field, look);
        const QImage first = shown.settled();
        for (int i = 0; i < 20; ++i) {
            field.set_time(0.032 * i);
            shown.scene.update_field(field);
            if (i % 3 == 0) shown.next_frame();
        }
        const QImage after = shown.settled(look.surface ? "played" : "played_volume_slices");
        EXPECT_GT(difference(first, after), 0.1);
        // Between two frames the flattened volume is rounded to the samples' type.
        EXPECT_LT(difference(picture_of(flat(field), look), after), 0.6);
    }
}

TEST(DrawnChangingScene, a_new_volume_takes_the_place_of_one_that_is_edited) {
    Field field = linear_field(scenes::ball(support::cube(120)));
    ShownScene shown;
    open(shown, field, surface_alone());
    for (int i = 0; i < 3; ++i) {
        field.use(dab(field, 128, i, 20).samples);
        shown.scene.update_field(field);
    }
    const Field other = linear_field(scenes::ball(support::cube(50)));
    open(shown, other, surface_alone());
    EXPECT_LT(difference(picture_of(other, surface_alone()), shown.settled()), 0.01);
}

TEST(DrawnChangingScene, pictures_come_while_a_stroke_goes_on) {
    Field field = linear_field(scenes::ball(support::cube(100)));
    ShownScene shown;
    open(shown, field, surface_alone());
    const QImage before = shown.settled();
    // No end to it until one has been seen.
    int versions = 0;
    wait_until([&] {
        field.use(dab(field, 128, 0.1 * ++versions, 9).samples);
        shown.scene.update_field(field);
        const QImage now = shown.scene.picture().convertToFormat(QImage::Format_RGB32);
        // Coarser while it goes on: the cut makes more of a difference than that.
        return versions > 20 && !shown.scene.settled() && difference(now, before) > 0.6;
    });
}

TEST(ChangingScene, another_grid_is_no_version) {
    ShownScene shown;
    const Field field = linear_field(scenes::ball(support::cube(20)));
    EXPECT_THROW(shown.scene.update_field(field), std::invalid_argument);
    shown.scene.set_field(field, 128);
    EXPECT_THROW(shown.scene.update_field(linear_field(scenes::ball(support::cube(21)))),
                 std::invalid_argument);
}

}  // namespace
}  // namespace palpate::viewer
