// Layers in the panel: choice, list, editor, plot.
#include <QAbstractButton>
#include <QComboBox>
#include <QContextMenuEvent>
#include <QDir>
#include <QLineEdit>
#include <QListWidget>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/stroke_plot.hpp"
#include "apps/viewer/window/isovalue_controls.hpp"
#include "tests/viewer/panel/layers_fixture.hpp"

namespace palpate::viewer {
namespace {

using enum HapticProperty;

using LayersPart = LayersFixture;

TEST_F(LayersPart, a_choice_is_one_command_and_none_goes_back_to_the_isovalue) {
    choose(1);
    ASSERT_EQ(of<command::UseLayers>().size(), 1U);
    EXPECT_EQ(asked(), choices[0].layers);
    EXPECT_TRUE(of<command::Isovalue>().empty());
    EXPECT_FALSE(find<QWidget>("isovalue_box")->isEnabled());
    choose(2);
    EXPECT_EQ(asked(), choices[1].layers);
    EXPECT_EQ(find<QLabel>("layers_note")->text(), "These are for CT");
    choose(0);
    EXPECT_EQ(of<command::UseLayers>().back().layers, nullptr);
    EXPECT_TRUE(of<command::Isovalue>().empty()) << "the run goes back to it";
    EXPECT_EQ(effect.isovalue(), 300);
    EXPECT_TRUE(find<QWidget>("isovalue_box")->isEnabled());
    EXPECT_TRUE(find<QLabel>("layers_note")->text().isEmpty());
}

TEST_F(LayersPart, undo_and_redo_stand_beside_the_choice_in_the_narrowest_panel) {
    panel.resize(panel.minimumSizeHint().width(), 1450);
    settle();
    auto* box = find<QComboBox>("layers");
    for (const char* name : {"undo_layers", "redo_layers"}) {
        const auto* one = find<QPushButton>(name);
        EXPECT_LE(one->y(), box->geometry().center().y()) << name;
        EXPECT_GT(one->x(), box->x()) << name;
    }
}

TEST_F(LayersPart, a_refused_set_is_not_shown_as_chosen) {
    refuse_with = "layers need the method exact";
    choose(1);
    EXPECT_EQ(find<QComboBox>("layers")->currentIndex(), 0);
    EXPECT_EQ(message("layers_part"), refuse_with);
    EXPECT_FALSE(effect.settings().layers);
}

TEST_F(LayersPart, each_property_of_the_chosen_layer_can_be_set) {
    choose(1);
    find<QListWidget>("layer_list")->setCurrentRow(1);
    type("layer_level", "400");
    EXPECT_FALSE(find<QWidget>("layer_drag_box")->isEnabled()) << "only a needle rubs";
    tick("needle");
    EXPECT_EQ(layer(1).level, 400);
    const std::pair<const char*, HapticProperty> properties[] = {
        {"layer_stiffness_box", stiffness},
        {"layer_static_friction_box", static_friction},
        {"layer_dynamic_friction_box", dynamic_friction},
        {"layer_damping_box", damping},
        {"layer_viscosity_box", viscosity},
        {"layer_drag_box", HapticProperty::drag}};
    double value = 0.0001;
    for (const auto& [box, property] : properties) {
        value += 0.0001;
        type(box, QString::number(value));
        EXPECT_NEAR(layer(1)[property].value_or(-1), value, 1e-9) << box;
    }
    type("layer_opacity_box", "0.5");
    EXPECT_EQ(layer(1).opacity, 0.5);
    EXPECT_EQ(layer(0).level, -300);
    EXPECT_NO_THROW(check(*asked(), Solid::above));
}

TEST_F(LayersPart, a_value_is_cleared_back_to_the_curve_or_the_session) {
    choose(1);
    auto* box = find<NumberBox>("layer_stiffness_box");
    auto* clear = find<QAbstractButton>("layer_stiffness_clear");
    EXPECT_FALSE(box->font().italic());
    EXPECT_TRUE(clear->toolTip().contains("session")) << clear->toolTip().toStdString();
    press("layer_stiffness_clear");
    settle();
    EXPECT_FALSE(layer(0)[stiffness]);
    EXPECT_EQ(box->value(), effect.settings().force.stiffness) << "what then counts";
    EXPECT_TRUE(box->font().italic());
    EXPECT_FALSE(clear->isEnabled());
    press("start_curve");
    EXPECT_TRUE(box->toolTip().isEmpty());
    type("layer_stiffness_box", "0.7");
    EXPECT_TRUE(clear->isEnabled());
    EXPECT_TRUE(clear->toolTip().contains("curve")) << clear->toolTip().toStdString();
    press("undo_layers");
    EXPECT_FALSE(layer(0)[stiffness]);
}

/// Two labels on the field's grid, with places.
SharedLayers two_labels(const Volume& volume) {
    Layers layers;
    layers.name = "by label";
    layers.by_label = true;
    for (const int label : {3, 5}) {
        Layer layer;
        layer.name = "organ " + std::to_string(label);
        layer.level = label;
        layers.layers.push_back(layer);
    }
    std::vector<std::uint8_t> samples(std::size_t(sample_count(volume.geometry())));
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = i % 3 == 0 ? 3 : i % 3 == 1 ? 5 : 0;
    const Volume labels(volume.geometry(), samples);
    layers.labels = numbered_labels(labels, layers.layers);
    return std::make_shared<const Layers>(layers);
}

TEST_F(LayersPart, layers_by_label_have_an_order_instead_of_levels) {
    panel.layers_controls().use(two_labels(field->volume()));
    settle();
    ASSERT_TRUE(asked());
    EXPECT_FALSE(find<QWidget>("layer_level")->isEnabled());
    EXPECT_FALSE(find<QWidget>("add_layer")->isEnabled());
    EXPECT_FALSE(find<QWidget>("add_layer")->toolTip().isEmpty());
    type("layer_stiffness_box", "0.2");
    EXPECT_EQ(layer(0)[stiffness], 0.2);
    const auto number_at = [&](int sample) {
        return asked()->labels->volume().sample(Index3(sample, 0, 0));
    };
    EXPECT_EQ(number_at(0), 1);
    press("layer_later");
    settle();
    EXPECT_EQ(layer(0).level, 5);
    EXPECT_EQ(number_at(0), 2);
    EXPECT_EQ(number_at(1), 1);
    EXPECT_EQ(number_at(2), 0);
    EXPECT_EQ(find<QListWidget>("layer_list")->currentRow(), 1) << "the same layer stays chosen";
    EXPECT_FALSE(find<QWidget>("layer_later")->isEnabled());
    QDir().mkpath(PALPATE_PICTURES);
    panel.grab().save(QString(PALPATE_PICTURES) + "/layers_by_label.png");
    press("remove_layer");
    settle();
    EXPECT_EQ(number_at(0), 0);
    EXPECT_EQ(number_at(1), 1);
    press("undo_layers");
    EXPECT_EQ(number_at(0), 2);
    choose(0);
    EXPECT_FALSE(find<QWidget>("layer_later")->isVisible());
}

TEST_F(LayersPart, what_has_no_effect_meanwhile_is_disabled_and_says_why) {
    Look look;
    look.surfaces = {{1000, {0, 0, 1}, 0.5, true}};
    panel.look_controls().set_look(look);
    const QString tip = find<QWidget>("threshold_box")->parentWidget()->toolTip();
    const char* resting[] = {"isovalue_box", "isovalue_slider", "penetrability", "add_range",
                             "surface_1_feel"};
    for (const bool layered : {true, false}) {
        choose(layered ? 1 : 0);
        for (const char* name : resting) {
            auto* one = find<QWidget>(name);
            EXPECT_EQ(one->isEnabled(), !layered) << name;
            QString said = one->toolTip();
            for (QWidget* at = one; said.isEmpty(); at = at->parentWidget()) said = at->toolTip();
            EXPECT_EQ(said.contains("No layers"), layered) << name << said.toStdString();
        }
    }
    EXPECT_EQ(find<QWidget>("threshold_box")->parentWidget()->toolTip(), tip);
    choose(1);
    LevelChart& chart = panel.isovalue_controls().chart();
    const double y = chart.strip().top() - 40;
    drag(&chart, {40, y}, {120, y}, Qt::ShiftModifier);
    chart.setFocus();
    QTest::keyClick(&chart, Qt::Key_Right);
    effect.request(command::Isovalue{500});  // as by a key
    EXPECT_TRUE(of<Penetrability>().empty());
    EXPECT_TRUE(of<command::Isovalue>().empty());
    EXPECT_TRUE(message("isovalue_part").contains("No layers"));
    EXPECT_EQ(effect.isovalue(), 300);
}

TEST_F(LayersPart, every_control_has_a_name_of_its_own_and_a_tip) {
    choose(2);
    std::set<QString> names;
    auto* controls = find<QWidget>("layers_controls");
    for (auto* one : controls->findChildren<QWidget*>()) {
        if (one->focusProxy() || !(one->focusPolicy() & Qt::TabFocus)) continue;
        if (one->objectName().startsWith("qt_") || !one->isVisible()) continue;
        QString tip;
        for (QWidget* at = one; at != controls && tip.isEmpty(); at = at->parentWidget()) {
            tip = at->toolTip();
        }
        EXPECT_NE(tip, "") << one->objectName().toStdString();
        const auto* button = qobject_cast<QAbstractButton*>(one);
        QString name = one->accessibleName();
        if (name.isEmpty() && button) name = button->text();
        EXPECT_NE(name, "") << one->objectName().toStdString();
        if (!button) continue;
        EXPECT_TRUE(names.insert(name).second) << name.toStdString();
    }
}

TEST_F(LayersPart, a_puncture_force_may_be_never) {
    choose(1);
    EXPECT_FALSE(find<QAbstractButton>("layer_never")->isChecked());
    tick("layer_never");
    EXPECT_EQ(layer(0)[puncture_force], std::numeric_limits<double>::infinity());
    settle();
    EXPECT_FALSE(find<QWidget>("layer_puncture_force_box")->isEnabled());
    tick("layer_never");
    EXPECT_EQ(layer(0)[puncture_force], 1.2) << "as it was";
    tick("needle");
    EXPECT_TRUE(asked()->needle);
}

TEST_F(LayersPart, closing_and_the_numbers_of_a_needle_can_be_set) {
    choose(2);  // with a needle
    type("layers_closing_box", "2.5");
    type("needle_lateral_box", "0.45");
    type("needle_static_ratio_box", "1.5");
    type("needle_stick_speed_box", "3");
    ASSERT_TRUE(asked()->needle);
    EXPECT_EQ(asked()->closing, 2.5);
    EXPECT_EQ(asked()->needle->lateral_stiffness, 0.45);
    EXPECT_EQ(asked()->needle->static_ratio, 1.5);
    EXPECT_EQ(asked()->needle->stick_speed, 3);
    type("needle_static_ratio_box", "0.5");
    EXPECT_TRUE(message("layers_part").contains("static ratio of the needle"));
    EXPECT_EQ(effect.settings().layers->needle->static_ratio, 1.5);
    EXPECT_EQ(find<NumberBox>("needle_static_ratio_box")->value(), 1.5);
    tick("needle");
    EXPECT_FALSE(asked()->needle);
    EXPECT_FALSE(find<QWidget>("needle_lateral")->isVisible());
    EXPECT_EQ(asked()->closing, 2.5);
    press("undo_layers");
    EXPECT_EQ(find<NumberBox>("needle_lateral_box")->value(), 0.45);
}

TEST_F(LayersPart, a_name_twice_is_refused_with_the_reason) {
    choose(1);
    auto* name = find<QLineEdit>("layer_name");
    name->setFocus();
    name->selectAll();
    QTest::keyClicks(name, "bone");
    QTest::keyClick(name, Qt::Key_Return);
    settle();
    EXPECT_TRUE(message("layers_part").contains("twice")) << message("layers_part").toStdString();
    EXPECT_EQ(layer(0).name, "skin");
    EXPECT_EQ(find<QListWidget>("layer_list")->item(0)->text().section(' ', 0, 0), "skin");
}

TEST_F(LayersPart, a_refused_change_leaves_nothing_to_undo_and_what_could_be_redone) {
    auto& undo = *find<QAbstractButton>("undo_layers");
    auto& redo = *find<QAbstractButton>("redo_layers");
    const QString reason = "layers need the method exact";
    refuse_with = reason;
    choose(1);
    EXPECT_FALSE(undo.isEnabled());
    refuse_with.clear();
    choose(1);
    find<QListWidget>("layer_list")->setCurrentRow(0);
    type("layer_level", "200");
    press("undo_layers");
    settle();
    ASSERT_TRUE(redo.isEnabled());
    refuse_with = reason;
    press("redo_layers");
    type("layer_level", "210");
    settle();
    EXPECT_TRUE(redo.isEnabled());
    refuse_with.clear();
    press("redo_layers");
    settle();
    EXPECT_EQ(layer(0).level, 200);
}

TEST_F(LayersPart, layers_are_added_and_removed_and_the_last_one_ends_it) {
    press("add_layer");
    ASSERT_EQ(asked()->layers.size(), 1U);
    EXPECT_EQ(layer(0).level, 300) << "at the isovalue";
    choose(1);
    press("add_layer");
    ASSERT_EQ(asked()->layers.size(), 3U);
    EXPECT_EQ(find<QListWidget>("layer_list")->count(), 3);
    for (int left = 2; left > 0; --left) {
        press("remove_layer");
        EXPECT_EQ(asked()->layers.size(), std::size_t(left));
    }
    press("remove_layer");
    EXPECT_EQ(of<command::UseLayers>().back().layers, nullptr);
    press("undo_layers");
    EXPECT_EQ(asked()->layers.size(), 1U);
    for (int i = 0; i < 3; ++i) press("undo_layers");
    EXPECT_EQ(of<command::UseLayers>().back().layers, choices[0].layers);
}

TEST_F(LayersPart, marks_on_the_histogram_are_layers_first_then_other_surfaces) {
    choose(1);
    Look look;
    look.surfaces = {{1000, {0, 0, 1}, 0.5, true}};
    panel.look_controls().set_look(look);
    LevelChart& chart = panel.isovalue_controls().chart();
    const LevelAxis axis = chart.axis();
    const double y = chart.strip().top() - 4;
    drag(&chart, {axis.x_of(1000), y}, {axis.x_of(1500), y});
    settle();
    EXPECT_NEAR(panel.look_controls().look().surfaces[0].level, 1500, 30);
    EXPECT_EQ(of<command::UseLayers>().size(), 1U);
    drag(&chart, {axis.x_of(-300), y}, {axis.x_of(2500), y});
    EXPECT_LT(layer(0).level, 250);
    EXPECT_GT(layer(0).level, 200) << "up to its neighbour";
}

TEST_F(LayersPart, what_the_device_cannot_render_is_marked_with_what_it_renders) {
    choose(1);
    auto* list = find<QListWidget>("layer_list");
    EXPECT_FALSE(list->item(0)->text().contains("rendered"));
    type("layer_stiffness_box", "20");
    settle();
    EXPECT_TRUE(list->item(0)->text().contains("rendered at"))
        << list->item(0)->text().toStdString();
    EXPECT_TRUE(list->item(0)->toolTip().contains("20"));
    EXPECT_EQ(layer(0)[stiffness], 20) << "as it was asked for";
}

TEST_F(LayersPart, a_drag_of_a_slider_is_one_step_to_undo) {
    choose(1);
    auto* slider = find<QSlider>("layer_stiffness_slider");
    const auto drag_slider = [&](int one_step_ms) {
        panel.layers_controls().set_one_step(one_step_ms);
        for (const int place : {200, 300, 400}) {
            slider->setValue(place);
            settle();
        }
    };
    drag_slider(std::numeric_limits<int>::max());
    EXPECT_NE(layer(0)[stiffness], 0.3);
    press("undo_layers");
    EXPECT_EQ(layer(0)[stiffness], 0.3);
    press("redo_layers");
    EXPECT_NE(layer(0)[stiffness], 0.3);
    press("undo_layers");
    drag_slider(0);
    press("undo_layers");
    EXPECT_NE(layer(0)[stiffness], 0.3) << "changes far apart are steps of their own";
}

TEST_F(LayersPart, the_curve_of_stiffness_is_dragged_and_gets_and_loses_points) {
    Layers layers = *choices[0].layers;
    layers.layers[0][stiffness].reset();
    layers[stiffness].density.knots = {{-500, 0.2}, {1000, 1}};
    choices[0].layers = std::make_shared<const Layers>(layers);
    panel.layers_controls().set_choices(choices);
    choose(1);
    LevelChart& chart = panel.isovalue_controls().chart();
    const LevelAxis axis = chart.axis();
    const auto knots = [&] { return (*asked())[stiffness].density.knots; };
    const auto place = [&](int knot) {
        const double bottom = chart.strip().top();
        const Curve::Knot& at = chart.curve().knots[std::size_t(knot)];
        const double top = 0.5 * chart.fontMetrics().height() + 2;
        return QPointF(axis.x_of(at.at), bottom - at.value / chart.curve().top * (bottom - top));
    };
    drag(&chart, place(1), place(1) + QPointF(40, 20));
    settle();
    ASSERT_EQ(knots().size(), 2U);
    EXPECT_GT(knots()[1].at, 1100);
    EXPECT_LT(knots()[1].value, 0.95);
    EXPECT_EQ(knots()[0].value, 0.2);
    drag(&chart, place(1), {axis.x_of(-900), place(1).y()});
    settle();
    EXPECT_GT(knots()[1].at, -500) << "not past its neighbour";
    const QPoint between(int(axis.x_of(0)), int(place(0).y()) - 20);
    QTest::mouseDClick(&chart, Qt::LeftButton, {}, between);
    QTest::mouseRelease(&chart, Qt::LeftButton, {}, between);
    settle();
    ASSERT_EQ(knots().size(), 3U);
    EXPECT_NO_THROW(check(*asked(), Solid::above));
    QDir().mkpath(PALPATE_PICTURES);
    panel.grab().save(QString(PALPATE_PICTURES) + "/layers_curve.png");
    chart.setFocus();
    QTest::keyClick(&chart, Qt::Key_Delete);
    settle();
    EXPECT_EQ(knots().size(), 2U);
    QContextMenuEvent right(QContextMenuEvent::Mouse, place(0).toPoint());
    QApplication::sendEvent(&chart, &right);
    settle();
    EXPECT_EQ(knots().size(), 1U);
    press("undo_layers");
    EXPECT_EQ(knots().size(), 2U);
}

TEST_F(LayersPart, what_is_touched_is_named_and_plotted) {
    choose(1);
    Snapshot now;
    now.normal = Vec3(0, 0, 1);
    for (int i = 0; i < 60; ++i) {
        const bool through = i >= 30;
        now.session.tick.time = 0.03 * i;
        now.session.tick.proxy.hip = Vec3(0, 0, -0.1 * i);
        now.session.tick.force = Vec3(0, 0, 0.04 * (through ? 1.5 * (i - 30) : i));
        now.session.tick.layers = {std::int8_t(through ? 1 : 0), std::int8_t(through ? 1 : 0), 0};
        panel.layers_controls().show_snapshot(now);
    }
    EXPECT_EQ(find<QLabel>("touched_layers")->text(), "on bone, in skin");
    EXPECT_EQ(find<StrokePlot>("stroke_plot")->stroke().points().size(), 60U);
    for (const bool dark : {false, true}) {
        const QPalette usual = QApplication::palette();
        QPalette palette(QColor(58, 58, 62), QColor(45, 45, 48));
        palette.setColor(QPalette::Base, QColor(28, 28, 30));
        if (dark) QApplication::setPalette(palette);
        panel.resize(panel.width(), 1450);
        QApplication::processEvents();
        QDir().mkpath(PALPATE_PICTURES);
        panel.grab().save(QString(PALPATE_PICTURES) + (dark ? "/layers_dark" : "/layers_light") +
                          ".png");
        QApplication::setPalette(usual);
    }
    press("clear_stroke");
    EXPECT_TRUE(find<StrokePlot>("stroke_plot")->stroke().points().empty());
}

TEST_F(LayersPart, the_panel_stays_narrow) {
    choose(2);
    EXPECT_LE(panel.minimumSizeHint().width(), 26 * panel.fontMetrics().height());
}

}  // namespace
}  // namespace palpate::viewer
