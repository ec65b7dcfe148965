// The look controls and the transfer function, used by mouse and keys.
#include "tests/viewer/panel/panel_fixture.hpp"

#include <QCheckBox>
#include <QColorDialog>
#include <QComboBox>
#include <QContextMenuEvent>

#include <memory>

#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/colours.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/level_chart.hpp"
#include "tests/viewer/transfer_function.hpp"

namespace palpate::viewer {
namespace {

class Looks : public PanelFixture {
  protected:
    Looks() {
        QObject::connect(&panel.look_controls(), &LookControls::look_changed,
                         [this](const Look& l) { looks.push_back(l); });
        set();
        look.transfer = preset("CT bone", histogram, field->volume());
        panel.look_controls().set_look(look);
    }
    ~Looks() override {
        for (const Look& one : looks) EXPECT_TRUE(is_valid(one.transfer));
        EXPECT_TRUE(commands.empty()) << "a look is no command";
    }
    LevelChart* editor() { return find<LevelChart>("transfer_editor"); }
    QPointF place(std::size_t point) { return editor()->place_of(point); }
    void right_click(const QPointF& at) {
        QContextMenuEvent click(QContextMenuEvent::Mouse, at.toPoint());
        QApplication::sendEvent(editor(), &click);
    }
    /// The second press, and its release.
    void double_click(const QPointF& at) {
        QTest::mouseDClick(editor(), Qt::LeftButton, {}, at.toPoint());
        QTest::mouseRelease(editor(), Qt::LeftButton, {}, at.toPoint());
    }
    const TransferFunction& transfer() { return panel.look_controls().look().transfer; }
    const Look& last() {
        settle();
        EXPECT_FALSE(looks.empty());
        return looks.empty() ? look : looks.back();
    }

    Look look;
    std::vector<Look> looks;
};

TEST_F(Looks, each_switch_changes_its_own_and_nothing_else) {
    const std::pair<const char*, bool Look::*> switches[] = {
        {"show_surface", &Look::surface},
        {"show_volume", &Look::volume},
        {"show_shading", &Look::shading},
        {"show_maximum", &Look::maximum},
        {"show_slices", &Look::slices},
        {"show_contact", &Look::contact},
        {"show_tetrahedra", &Look::tetrahedra},
        {"show_planes", &Look::planes},
        {"show_box", &Look::box},
        {"show_orientation", &Look::orientation},
        {"show_scale_bar", &Look::scale_bar}};
    for (const auto& [name, member] : switches) {
        SCOPED_TRACE(name);
        panel.look_controls().set_look(look);
        find<QCheckBox>(name)->click();
        Look expected = look;
        expected.*member = !(look.*member);
        EXPECT_EQ(last(), expected);
        EXPECT_EQ(panel.look_controls().look(), expected);
    }
}

TEST_F(Looks, surfaces_are_added_at_suggested_levels_as_glass_where_they_lie_outside) {
    const auto suggested = run::suggested_isovalues(histogram);
    ASSERT_EQ(suggested.size(), 2U);
    press("add_surface");
    Look now = last();
    ASSERT_EQ(now.surfaces.size(), 1U);
    EXPECT_EQ(now.surfaces[0].level, suggested[0]);
    EXPECT_LT(now.surfaces[0].level, 300) << "below the level felt";
    EXPECT_LT(now.surfaces[0].opacity, 1);
    EXPECT_EQ(now.surface_opacity, 1);
    press("add_surface");
    now = last();
    ASSERT_EQ(now.surfaces.size(), 2U);
    EXPECT_EQ(now.surfaces[1].level, suggested[1]);
    EXPECT_EQ(now.surfaces[1].opacity, 1);
    EXPECT_LT(now.surface_opacity, 1) << "the one felt hides it";
    EXPECT_NE(now.surfaces[0].colour, now.surfaces[1].colour);
}

TEST_F(Looks, a_surface_is_hidden_moved_made_glass_and_removed) {
    look.surfaces = {{100, {1, 0, 0}, 1, true}, {700, {0, 1, 0}, 1, true}};
    panel.look_controls().set_look(look);
    find<QCheckBox>("surface_2")->click();
    EXPECT_FALSE(last().surfaces[1].shown);
    type("surface_1_level", "150");
    EXPECT_EQ(last().surfaces[0].level, 150);
    type("surface_1_opacity", "0.5");
    EXPECT_EQ(last().surfaces[0].opacity, 0.5);
    type("surface_1_opacity", "7");
    EXPECT_EQ(last().surfaces[0].opacity, 1);
    press("surface_1_remove");
    ASSERT_EQ(last().surfaces.size(), 1U);
    EXPECT_EQ(last().surfaces[0].level, 700);
    EXPECT_FALSE(find<QCheckBox>("surface_2")->isVisible());
}

TEST_F(Looks, no_more_surfaces_than_there_is_room_for) {
    for (std::size_t i = 0; i < most_surfaces + 2; ++i) press("add_surface");
    EXPECT_EQ(last().surfaces.size(), most_surfaces);
    EXPECT_FALSE(find<QPushButton>("add_surface")->isEnabled());
}

TEST_F(Looks, levels_of_surfaces_are_dragged_on_the_histogram) {
    look.surfaces = {{800, {1, 0, 0}, 1, true}};
    panel.look_controls().set_look(look);
    auto* chart = find<LevelChart>("level_chart");
    const LevelAxis axis = chart->axis();
    const double y = chart->strip().top() - 3;
    drag(chart, {axis.x_of(800), y}, {axis.x_of(1500), y});
    EXPECT_NEAR(last().surfaces[0].level, 1500, 2 * (axis.high - axis.low) / chart->width());
    EXPECT_EQ(find<NumberBox>("surface_1_level")->value(), last().surfaces[0].level);
}

TEST_F(Looks, a_look_that_is_set_is_shown) {
    Look other;
    other.surface = false;
    other.surface_opacity = 0.4;
    other.volume = true;
    other.transfer = preset("CT skin", histogram, field->volume());
    panel.look_controls().set_look(other);
    settle();
    EXPECT_EQ(views.shown().look, other);
    EXPECT_FALSE(find<QCheckBox>("show_surface")->isChecked());
    EXPECT_EQ(find<NumberBox>("surface_opacity_box")->value(), 0.4);
    EXPECT_EQ(find<QComboBox>("preset")->currentText(), "CT skin");
    EXPECT_EQ(panel.look_controls().look(), other);
}

TEST_F(Looks, opacity_is_between_none_and_all) {
    type("surface_opacity_box", "0.3");
    EXPECT_EQ(last().surface_opacity, 0.3);
    type("surface_opacity_box", "7");
    EXPECT_EQ(last().surface_opacity, 1);
    EXPECT_EQ(find<NumberBox>("surface_opacity_box")->value(), 1);
}

TEST_F(Looks, a_point_is_dragged_between_its_neighbours) {
    const TransferFunction before = look.transfer;
    drag(editor(), place(3), place(3) + QPointF(5, -20));
    EXPECT_EQ(last().transfer.preset, "");
    EXPECT_EQ(last().transfer.points.size(), before.points.size());
    EXPECT_GT(last().transfer.points[3].level, before.points[3].level);
    EXPECT_GT(last().transfer.points[3].opacity, before.points[3].opacity);
    EXPECT_EQ(last().transfer.points[3].colour, before.points[3].colour);
    EXPECT_EQ(find<QComboBox>("preset")->currentIndex(), -1);
    // Past its neighbours it does not go.
    drag(editor(), place(3), QPointF(editor()->width() - 1, -50));
    EXPECT_LT(last().transfer.points[3].level, last().transfer.points[4].level);
    EXPECT_EQ(last().transfer.points[3].opacity, 1);
    EXPECT_EQ(last().transfer.points[2], before.points[2]);
}

TEST_F(Looks, a_second_press_on_a_point_drags_it_too) {
    const QPointF from = place(3), to = from + QPointF(5, -20);
    QTest::mouseClick(editor(), Qt::LeftButton, {}, from.toPoint());
    QTest::mouseDClick(editor(), Qt::LeftButton, {}, from.toPoint());
    for (int i = 1; i <= 8; ++i) move(editor(), from + (to - from) * (i / 8.0));
    QTest::mouseRelease(editor(), Qt::LeftButton, {}, to.toPoint());
    EXPECT_GT(last().transfer.points[3].level, look.transfer.points[3].level);
    EXPECT_GT(last().transfer.points[3].opacity, look.transfer.points[3].opacity);
    EXPECT_EQ(panel.findChild<QColorDialog*>(), nullptr) << "it was no double click";
}

TEST_F(Looks, a_double_click_adds_a_point_with_the_colour_that_is_there) {
    const QPointF at(0.5 * (place(4).x() + place(5).x()), place(4).y() + 25);
    double_click(at);
    const auto& points = last().transfer.points;
    ASSERT_EQ(points.size(), look.transfer.points.size() + 1);
    const ControlPoint was = sampled(look.transfer, points[5].level);
    EXPECT_EQ(points[5].colour, was.colour);
    EXPECT_LT(points[5].opacity, was.opacity - 0.1);
    EXPECT_NEAR(place(5).x(), at.x(), 1.5);
    EXPECT_EQ(editor()->held_knot(), 5);
}

TEST_F(Looks, right_click_and_del_delete_points_but_two_stay) {
    right_click(place(2));
    EXPECT_EQ(last().transfer.points.size(), look.transfer.points.size() - 1);
    EXPECT_EQ(last().transfer.points[2], look.transfer.points[3]);
    editor()->setFocus();
    for (int i = 0; i < 20; ++i) {
        QTest::mouseClick(editor(), Qt::LeftButton, {}, place(1).toPoint());
        QTest::keyClick(editor(), Qt::Key_Delete);
    }
    EXPECT_EQ(last().transfer.points.size(), 2U);
}

TEST_F(Looks, choosing_the_preset_again_undoes_changes) {
    drag(editor(), place(3), place(3) + QPointF(5, -20));
    auto* box = find<QComboBox>("preset");
    box->setFocus();
    QTest::keyClick(box, Qt::Key_Home);
    EXPECT_EQ(last().transfer, look.transfer);
    EXPECT_EQ(transfer(), look.transfer);
}

TEST_F(Looks, keys_choose_and_move_points) {
    editor()->setFocus();
    editor()->hold_knot(2);
    QTest::keyClick(editor(), Qt::Key_PageDown);
    EXPECT_EQ(editor()->held_knot(), 3);
    const double y = place(3).y();
    QTest::keyClick(editor(), Qt::Key_Up, Qt::ShiftModifier);
    EXPECT_NEAR(place(3).y(), y - 10, 0.6) << "as far as dragging, to a hundredth";
    EXPECT_GT(last().transfer.points[3].opacity, look.transfer.points[3].opacity);
    QTest::keyClick(editor(), Qt::Key_Insert);
    EXPECT_EQ(last().transfer.points.size(), look.transfer.points.size() + 1);
    EXPECT_EQ(editor()->held_knot(), 4);
}

TEST_F(Looks, numbers_of_the_chosen_point_can_be_typed) {
    EXPECT_FALSE(find<QWidget>("point_level")->isEnabled());
    QTest::mouseClick(editor(), Qt::LeftButton, {}, place(3).toPoint());
    type("point_level", "401.5");
    EXPECT_EQ(last().transfer.points[3].level, 401.5);
    type("point_opacity", "0.62");
    EXPECT_EQ(last().transfer.points[3].opacity, 0.62);
    type("point_level", "1e9");  // kept below its neighbour, and shown so
    EXPECT_LT(last().transfer.points[3].level, last().transfer.points[4].level);
    EXPECT_EQ(find<NumberBox>("point_level")->value(), last().transfer.points[3].level);
    type("point_opacity", "-3");
    EXPECT_EQ(last().transfer.points[3].opacity, 0);
}

TEST_F(Looks, a_colour_is_chosen_in_a_dialog_and_cancelled) {
    press("surface_colour");
    auto* dialog = panel.findChild<QColorDialog*>();
    ASSERT_NE(dialog, nullptr);
    dialog->setCurrentColor(QColor(10, 200, 30));
    EXPECT_NEAR(last().surface_colour.green, 200 / 255.0, 1e-4);
    dialog->reject();
    EXPECT_EQ(last().surface_colour, look.surface_colour);
    double_click(place(3));
    dialog = nullptr;
    for (auto* one : panel.findChildren<QColorDialog*>()) {
        if (one->isVisible()) dialog = one;
    }
    ASSERT_NE(dialog, nullptr);
    dialog->setCurrentColor(QColor(0, 0, 255));
    dialog->accept();
    EXPECT_NEAR(last().transfer.points[3].colour.blue, 1, 1e-4);
    EXPECT_EQ(last().transfer.points[3].opacity, look.transfer.points[3].opacity);
}

TEST_F(Looks, the_panel_can_be_destroyed_during_a_drag_with_a_dialog_open) {
    Content its;
    Effect& own = its.effect();
    auto other = std::make_unique<Panel>(Desk(its, messages, views));
    int heard = 0;
    QObject::connect(&other->look_controls(), &LookControls::look_changed,
                     [&](const Look&) { ++heard; });
    own.begin(*field, 300, {}, desktop_device(), histogram, [](const Command&) {});
    other->look_controls().set_look(look);
    other->show();
    wait_until_exposed(*other);
    auto* held = other->findChild<LevelChart*>("transfer_editor");
    const QPointF at = held->place_of(3);
    drag(held, at, at + QPointF(8, -15), Qt::NoModifier, false);
    drag(other->findChild<QWidget*>("level_chart"), QPointF(80, 40), QPointF(200, 40),
         Qt::NoModifier, false);
    other->findChild<ColourButton*>("surface_colour")->click();
    const int before = heard;
    other.reset();
    settle();
    EXPECT_EQ(heard, before);
}

TEST_F(Looks, random_edits_always_leave_a_valid_function) {
    std::mt19937 random(21);
    const auto anywhere = [&] {
        return QPointF(std::uniform_int_distribution(-10, editor()->width() + 10)(random),
                       std::uniform_int_distribution(-10, editor()->height() + 10)(random));
    };
    for (int i = 0; i < 150; ++i) {
        const auto point = random() % transfer().points.size();
        switch (random() % 4) {
            case 0:
                drag(editor(), place(point), anywhere());
                break;
            case 1:
                drag(editor(), anywhere(), anywhere());
                break;
            case 2:
                editor()->hold_knot(static_cast<int>(point));
                QTest::keyClick(editor(), random() % 2 ? Qt::Key_Left : Qt::Key_Insert);
                break;
            default:
                right_click(place(point));
        }
        ASSERT_TRUE(is_valid(transfer())) << i;
    }
    EXPECT_EQ(last().transfer, transfer());
}

class Presets : public PanelFixture {
  protected:
    /// As the keys go through them.
    QStringList offered() {
        auto* box = find<QComboBox>("preset");
        box->setFocus();
        QTest::keyClick(box, Qt::Key_Home);
        QStringList names{box->currentText()};
        for (int i = 1; i < box->count(); ++i) {
            QTest::keyClick(box, Qt::Key_Down);
            names << box->currentText();
        }
        settle();
        return names;
    }
};

TEST_F(Presets, those_of_ct_are_offered_for_hounsfield_units_only) {
    set();
    EXPECT_EQ(offered(), (QStringList{"CT bone", "CT skin", "CT soft tissue", "Grey"}));
    EXPECT_EQ(panel.look_controls().look().transfer.preset, "Grey");
    std::vector<std::uint8_t> cells(1000, 3);
    cells.resize(1728, 190);
    Geometry geometry;
    geometry.size = {12, 12, 12};
    begin(linear_field(Volume(geometry, cells)), 90);
    EXPECT_EQ(offered(), (QStringList{"Dense parts", "Outer surface", "Soft parts", "MR",
                                      "Microscopy", "Grey"}));
    set();
    EXPECT_EQ(offered().front(), "CT bone");
}

using FeltSurfaces = PanelFixture;

TEST_F(FeltSurfaces, another_surface_is_felt_and_the_one_before_takes_its_place) {
    set();
    Look look;
    look.surfaces = {{700, {0, 1, 0}, 0.5, true}};
    panel.look_controls().set_look(look);
    press("surface_1_feel");
    ASSERT_EQ(of<command::Isovalue>().size(), 1U);
    EXPECT_EQ(of<command::Isovalue>()[0].isovalue, 700);
    const Look& now = panel.look_controls().look();
    EXPECT_EQ(now.surfaces[0].level, 300);
    EXPECT_EQ(now.surfaces[0].colour, look.surface_colour);
    EXPECT_EQ(now.surface_colour, look.surfaces[0].colour);
    EXPECT_EQ(now.surface_opacity, 0.5);
}

TEST_F(FeltSurfaces, one_that_cannot_be_felt_stays_where_it_is) {
    set();
    Look look;
    look.surfaces = {{700, {0, 1, 0}, 0.5, true}};
    panel.look_controls().set_look(look);
    refuse_with = "not now";
    press("surface_1_feel");
    EXPECT_EQ(panel.look_controls().look(), look);
    EXPECT_EQ(message("isovalue_part"), "not now");
}

}  // namespace
}  // namespace palpate::viewer
