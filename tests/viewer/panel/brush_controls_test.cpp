// The brush controls, alone and in the panel, used by mouse and keys.
#include "apps/viewer/window/brush_controls.hpp"

#include <QDir>
#include <QPalette>
#include <QSlider>
#include <QToolButton>

#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "tests/viewer/panel/panel_fixture.hpp"

namespace palpate::viewer {
namespace {

constexpr double at_once = std::numeric_limits<double>::infinity();

class Brushes : public PanelFixture {
  protected:
    /// The choice, if it is another one than at the last look.
    std::vector<BrushChoice> chosen() {
        settle();
        if (std::exchange(seen, brush()) == brush()) return {};
        return {seen};
    }
    /// A grid of 32 mm: radius from 1 to 8 mm.
    void edit(const BrushChoice& brush = {}) {
        set();
        panel.brush_controls().set_choice(brush);
        seen = brush;
    }
    /// A volume that can be edited, with two edits.
    void edit_twice() {
        feel("mouse");
        for (const int low : {2, 9}) editor().apply(edit::Fill{{{low, 5, 5}, {low + 4, 9, 9}}, 0});
        panel.brush_controls().observe();
    }
    run::VolumeEditor& editor() { return *content.editor(); }
    BrushChoice seen;
};

TEST_F(Brushes, each_control_changes_its_part_of_the_choice_once_and_nothing_else) {
    QSignalSpy changes(&panel.brush_controls(), &BrushControls::nonsense);
    const BrushChoice start{BrushKind::add, 4, 0.5, 20, 900.0, false};
    struct Case {
        const char* name;
        std::function<void()> act;
        std::function<void(BrushChoice&)> change;
    };
    const Case cases[] = {
        {"switch", [&] { press("brush"); }, [](BrushChoice& c) { c.on = true; }},
        {"radius", [&] { type("brush_radius_box", "5.5"); },
         [](BrushChoice& c) { c.radius = 5.5; }},
        {"hardness", [&] { type("brush_hardness_box", "0.25"); },
         [](BrushChoice& c) { c.hardness = 0.25; }},
        {"rate", [&] { type("brush_rate_box", "50"); }, [](BrushChoice& c) { c.rate = 50; }},
        {"at once", [&] { QTest::keyClick(find<QWidget>("brush_at_once"), Qt::Key_Space); },
         [](BrushChoice& c) { c.rate = at_once; }},
        {"value", [&] { type("brush_value", "1200"); }, [](BrushChoice& c) { c.value = 1200; }},
        {"automatic", [&] { QTest::keyClick(find<QWidget>("brush_automatic"), Qt::Key_Space); },
         [](BrushChoice& c) { c.value.reset(); }},
        {"paint", [&] { press("brush_paint"); },
         [](BrushChoice& c) { c.value.reset(), c.kind = BrushKind::paint; }},
    };
    for (const Case& one : cases) {
        SCOPED_TRACE(one.name);
        edit(start);
        changes.clear();
        one.act();
        ASSERT_EQ(changes.count(), 1);
        EXPECT_EQ(changes.front().front().toString(), "");
        BrushChoice expected = start;
        one.change(expected);
        const auto asked = chosen();
        ASSERT_EQ(asked.size(), 1U);
        EXPECT_EQ(asked.front(), expected);
        EXPECT_EQ(brush(), expected);
        EXPECT_TRUE(commands.empty());
    }
}

TEST_F(Brushes, a_choice_that_is_set_is_shown) {
    set();
    panel.brush_controls().set_choice({BrushKind::smooth, 7, 0.3, 12, 100.0, false, true});
    EXPECT_TRUE(find<QToolButton>("brush_smooth")->isChecked());
    EXPECT_TRUE(find<QPushButton>("brush")->isChecked());
    EXPECT_EQ(find<NumberBox>("brush_radius_box")->value(), 7);
    EXPECT_EQ(find<NumberBox>("brush_hardness_box")->value(), 0.3);
    EXPECT_EQ(find<NumberBox>("brush_rate_box")->value(), 12);
    EXPECT_FALSE(find<QWidget>("brush_value")->isEnabled()) << "smoothing has no value";
    panel.brush_controls().set_choice({BrushKind::carve, 5, 1, at_once, {}, false});
    EXPECT_TRUE(find<QCheckBox>("brush_at_once")->isChecked());
    EXPECT_FALSE(find<QWidget>("brush_rate")->isEnabled());
    EXPECT_TRUE(commands.empty());
}

TEST_F(Brushes, choosing_the_same_kind_again_changes_nothing) {
    edit({{.kind = BrushKind::smooth}});
    press("brush_smooth");
    EXPECT_TRUE(chosen().empty());
    press("brush_carve");
    EXPECT_EQ(chosen().size(), 1U);
    EXPECT_FALSE(find<QToolButton>("brush_smooth")->isChecked());
}

TEST_F(Brushes, arrow_keys_go_from_kind_to_kind) {
    edit();
    auto* carve = find<QToolButton>("brush_carve");
    carve->setFocus(Qt::TabFocusReason);
    QTest::keyClick(carve, Qt::Key_Right);
    const auto asked = chosen();
    ASSERT_EQ(asked.size(), 1U);
    EXPECT_EQ(asked[0].kind, BrushKind::add);
}

TEST_F(Brushes, the_radius_goes_from_a_voxel_to_a_quarter_of_the_grid_by_factors) {
    edit();
    auto* slider = find<QSlider>("brush_radius_slider");
    slider->setFocus();
    QTest::keyClick(slider, Qt::Key_End);
    auto asked = chosen();
    ASSERT_EQ(asked.size(), 1U);
    EXPECT_EQ(asked[0].radius, 8);  // 32 samples, a millimetre apart
    QTest::keyClick(slider, Qt::Key_Home);
    asked = chosen();
    ASSERT_EQ(asked.size(), 1U);
    EXPECT_EQ(asked[0].radius, 1);
    // Half the way is the geometric mean.
    drag(slider, QPointF(7, slider->height() / 2.0),  // the middle of its handle
         QPointF(slider->width() / 2.0, slider->height() / 2.0));
    asked = chosen();
    ASSERT_FALSE(asked.empty());
    EXPECT_NEAR(asked.back().radius, std::sqrt(8.0), 0.25);
    EXPECT_EQ(brush(), asked.back());
}

TEST_F(Brushes, values_out_of_range_are_refused_with_the_reason) {
    const BrushChoice start{BrushKind::carve, 4, 0.5, 20, {}, false};
    edit(start);
    type("brush_radius_box", "500");
    EXPECT_TRUE(message("edit_part").contains("from 1 mm (a voxel) to 8 mm"))
        << message("edit_part").toStdString();
    EXPECT_EQ(find<NumberBox>("brush_radius_box")->value(), 4);
    type("brush_hardness_box", "1.5");
    EXPECT_TRUE(message("edit_part").contains("hardness"));
    type("brush_rate_box", "0.5");
    EXPECT_TRUE(message("edit_part").contains("from 1 to 100 /s"));
    EXPECT_TRUE(chosen().empty());
    EXPECT_EQ(brush(), start);
    type("brush_radius_box", "6");
    EXPECT_EQ(message("edit_part"), "");
}

TEST_F(Brushes, an_automatic_value_is_the_one_that_fits_and_follows_the_level) {
    edit();
    auto* box = find<NumberBox>("brush_value");
    const auto fits = [&](BrushKind kind, double level) {
        return brush_for(kind, *field, level, 3).value;
    };
    EXPECT_EQ(box->value(), fits(BrushKind::carve, 300));
    press("brush_add");
    EXPECT_EQ(box->value(), fits(BrushKind::add, 300));
    type("isovalue_box", "500");
    EXPECT_EQ(box->value(), fits(BrushKind::add, 500));
    const auto asked = chosen();
    ASSERT_EQ(asked.size(), 1U) << "only the kind was chosen";
    EXPECT_FALSE(asked[0].value);
    // Without it, the number that stands there counts.
    QTest::keyClick(find<QWidget>("brush_automatic"), Qt::Key_Space);
    EXPECT_EQ(chosen().back().value, fits(BrushKind::add, 500));
}

TEST_F(Brushes, a_typed_value_is_remembered_for_its_kind) {
    edit();
    type("brush_value", "-900");
    press("brush_add");
    EXPECT_FALSE(brush().value) << "what carves does not fit to add";
    press("brush_carve");
    EXPECT_EQ(brush().value, -900);
    EXPECT_FALSE(find<QCheckBox>("brush_automatic")->isChecked());
}

TEST_F(Brushes, typing_the_number_that_is_there_ends_automatic) {
    edit();
    const double fits = find<NumberBox>("brush_value")->value();
    type("brush_value", QString::number(fits));
    const auto asked = chosen();
    ASSERT_EQ(asked.size(), 1U);
    EXPECT_EQ(asked[0].value, fits);
}

TEST_F(Brushes, the_rate_comes_back_when_it_is_not_at_once_any_more) {
    edit({{.rate = 40}});
    auto* box = find<QWidget>("brush_at_once");
    QTest::keyClick(box, Qt::Key_Space);
    EXPECT_FALSE(find<QWidget>("brush_rate_box")->isEnabled());
    QTest::keyClick(box, Qt::Key_Space);
    EXPECT_EQ(brush().rate, 40);
}

TEST_F(Brushes, undo_and_redo_say_how_many_steps_there_are) {
    feel("mouse");
    QSignalSpy save(&panel.brush_controls(), &BrushControls::save_wanted);
    press("undo");
    press("redo");
    EXPECT_FALSE(find<QPushButton>("undo")->isEnabled()) << "there is nothing to undo";
    EXPECT_EQ(find<QLabel>("edit_state")->text(), "Nothing was edited");
    edit_twice();
    EXPECT_EQ(find<QPushButton>("undo")->text(), "Undo (2)");
    press("undo");
    EXPECT_EQ(editor().state().undo_steps, 1U) << "one step for one press";
    panel.brush_controls().observe();
    EXPECT_EQ(find<QPushButton>("redo")->accessibleName(), "Redo, one step");
    EXPECT_EQ(find<QLabel>("edit_state")->text(), "There are edits that are not saved");
    auto* redo = find<QPushButton>("redo");
    redo->setFocus();
    QTest::keyClick(redo, Qt::Key_Return);
    EXPECT_EQ(editor().state().undo_steps, 2U);
    press("save_edits");
    EXPECT_EQ(save.count(), 1);
    editor().set_saved(editor().state().samples);
    panel.brush_controls().observe();
    EXPECT_EQ(find<QLabel>("edit_state")->text(), "Nothing is left to save");
}

TEST_F(Brushes, a_sequence_cannot_be_edited_and_it_says_why) {
    edit_twice();
    feel("mouse", "synthetic:beating:24x24x24");
    chosen();
    auto* why = find<QLabel>("brush_reason");
    EXPECT_EQ(why->text(), "A sequence cannot be edited: open one frame of it (--time-step).");
    EXPECT_TRUE(why->isVisible());
    EXPECT_TRUE(why->isEnabled()) << "it is to be read";
    for (const char* name : {"brush", "brush_carve", "brush_radius", "undo", "save_edits"}) {
        EXPECT_FALSE(find<QWidget>(name)->isEnabled()) << name;
    }
    EXPECT_FALSE(find<QPushButton>("brush")->isChecked());
    press("brush");
    panel.brush_controls().toggle();
    EXPECT_TRUE(chosen().empty());
    feel("mouse");
    EXPECT_FALSE(why->isVisible());
    press("brush");
    EXPECT_TRUE(find<QPushButton>("brush")->isChecked());
}

TEST_F(Brushes, a_choice_that_the_editor_refuses_goes_back_and_says_why) {
    feel("mouse");
    press("brush");
    const BrushChoice before = brush();
    ASSERT_TRUE(before.on);
    BrushChoice impossible = before;
    impossible.kind = BrushKind::paint;
    impossible.hardness = 2;
    panel.brush_controls().set_choice(impossible);
    EXPECT_EQ(brush(), before);
    EXPECT_TRUE(find<QToolButton>("brush_carve")->isChecked());
    EXPECT_TRUE(message("edit_part").contains("hardness of the brush = 2: must be from 0 to 1"))
        << message("edit_part").toStdString();
    press("brush_paint");
    EXPECT_EQ(brush().kind, BrushKind::paint);
    EXPECT_EQ(message("edit_part"), "");
}

TEST_F(Brushes, another_volume_begins_with_the_brush_off_and_a_radius_that_fits) {
    edit_twice();
    ASSERT_TRUE(find<QPushButton>("undo")->isEnabled());
    edit({BrushKind::carve, 7, 0.5, 20, -800.0, false, true});
    Geometry small;
    small.size = {12, 12, 12};
    const Field other = linear_field(Volume(small, std::vector<std::uint8_t>(12 * 12 * 12, 9)));
    begin(other, 4);
    EXPECT_FALSE(brush().on);
    EXPECT_FALSE(brush().value);
    EXPECT_EQ(brush().radius, 4);  // a thin grid leaves four voxels
    EXPECT_EQ(brush().hardness, 0.5);
    EXPECT_FALSE(find<QPushButton>("undo")->isEnabled());
}

TEST_F(Brushes, one_with_the_shape_of_the_tool_needs_a_tool_and_is_a_ball_again_without) {
    field.emplace(head_like(), Solid::above, std::nullopt, Interpolation::cubic);
    begin(*field, 300);
    panel.brush_controls().set_choice({BrushKind::carve, 5, 1, 10, {}, false, true});
    chosen();
    auto* shape = find<QCheckBox>("brush_as_tool");
    EXPECT_FALSE(shape->isEnabled());
    EXPECT_TRUE(shape->toolTip().contains("Feel"));
    const auto tool = std::make_shared<const Tool>(sphere_tool(4, 1));
    ASSERT_TRUE(effect.request(command::UseTool{tool}));
    EXPECT_TRUE(chosen().empty());
    QTest::keyClick(shape, Qt::Key_Space);
    auto made = chosen();
    ASSERT_EQ(made.size(), 1U);
    EXPECT_TRUE(made[0].as_tool);
    EXPECT_EQ(made[0].radius, 1) << "a voxel beyond the skin";
    type("brush_radius_box", "2.5");
    QTest::keyClick(shape, Qt::Key_Space);
    made = chosen();
    ASSERT_EQ(made.size(), 1U);
    EXPECT_FALSE(made[0].as_tool);
    EXPECT_EQ(made[0].radius, 5) << "the ball it was";
    QTest::keyClick(shape, Qt::Key_Space);
    EXPECT_EQ(chosen().back().radius, 2.5);
    ASSERT_TRUE(effect.request(command::UseTool{nullptr}));
    made = chosen();
    ASSERT_EQ(made.size(), 1U);
    EXPECT_FALSE(made[0].as_tool);
    EXPECT_EQ(made[0].radius, 5);
    EXPECT_FALSE(shape->isChecked());
}

TEST_F(Brushes, without_a_volume_or_while_looking_at_a_recording_nothing_can_be_edited) {
    panel.brush_controls().toggle();
    edit();
    effect.begin(*field, 300, {}, desktop_device(), histogram, nullptr);
    press("brush");
    panel.brush_controls().toggle();
    effect.end();
    panel.brush_controls().toggle();
    EXPECT_TRUE(chosen().empty());
}

TEST_F(Brushes, are_drawn_in_light_and_dark) {
    const QPalette usual = QApplication::palette();
    const auto picture = [&](const QString& name) {
        settle();
        const QImage image = find<QWidget>("edit_part")->grab().toImage();
        QDir().mkpath(PALPATE_PICTURES);
        const QString scale = image.devicePixelRatio() > 1.5 ? "_2x" : "";
        EXPECT_TRUE(image.save(QString(PALPATE_PICTURES) + "/" + name + scale + ".png"));
    };
    edit_twice();
    editor().undo();
    panel.brush_controls().observe();
    panel.brush_controls().set_choice({{.kind = BrushKind::add, .rate = 20}, true});
    picture("brush_light");
    QPalette dark(QColor(58, 58, 62), QColor(45, 45, 48));
    dark.setColor(QPalette::Base, QColor(28, 28, 30));
    QApplication::setPalette(dark);
    picture("brush_dark");
    feel("mouse", "synthetic:beating:24x24x24");
    picture("brush_reason_dark");
    QApplication::setPalette(usual);
}

TEST_F(Brushes, every_control_has_a_name_and_a_tip) {
    edit();
    auto* controls = find<QWidget>("brush_controls");
    for (auto* one : controls->findChildren<QWidget*>()) {
        if (one->focusProxy() || !(one->focusPolicy() & Qt::TabFocus)) continue;
        QString tip;
        for (QWidget* at = one; at != controls && tip.isEmpty(); at = at->parentWidget()) {
            tip = at->toolTip();
        }
        EXPECT_NE(tip, "") << one->objectName().toStdString();
        const auto* button = qobject_cast<QAbstractButton*>(one);
        EXPECT_FALSE(one->accessibleName().isEmpty() && (!button || button->text().isEmpty()))
            << one->objectName().toStdString();
    }
}

}  // namespace
}  // namespace palpate::viewer
