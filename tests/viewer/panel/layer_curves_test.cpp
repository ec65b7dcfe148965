// Curves of layers in the panel: over density, on the histogram, and over the gradient.
#include <QDir>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/viewer/window/isovalue_controls.hpp"
#include "tests/viewer/panel/layers_fixture.hpp"

namespace palpate::viewer {
namespace {

using enum HapticProperty;
using LayerCurves = LayersFixture;

TEST_F(LayerCurves, each_property_has_a_curve_that_begins_is_changed_and_ends) {
    choose(1);
    LevelChart& chart = panel.isovalue_controls().chart();
    auto* properties = find<QComboBox>("curve_property");
    ASSERT_EQ(properties->count(), haptic_property_count);
    for (int i = 0; i < haptic_property_count; ++i) {
        const auto property = static_cast<HapticProperty>(i);
        properties->setFocus();
        while (properties->currentIndex() < i) QTest::keyClick(properties, Qt::Key_Down);
        settle();
        EXPECT_TRUE(chart.curve().knots.empty()) << i;
        EXPECT_FALSE(find<QWidget>("remove_curve")->isEnabled());
        press("start_curve");
        settle();
        ASSERT_EQ((*asked())[property].density.knots.size(), 1U) << i;
        ASSERT_EQ(chart.curve().knots.size(), 1U);
        chart.setFocus();
        for (const Qt::Key key : {Qt::Key_PageDown, Qt::Key_Insert, Qt::Key_Up, Qt::Key_Up}) {
            QTest::keyClick(&chart, key);
        }
        settle();
        const auto knots = (*asked())[property].density.knots;
        ASSERT_EQ(knots.size(), 2U) << i;
        EXPECT_GT(knots[1].value, knots[0].value) << i;
        EXPECT_GT(knots[1].at, knots[0].at) << i;
        EXPECT_NO_THROW(check(*asked(), Solid::above));
        EXPECT_TRUE(properties->currentText().contains("(2)"));
        if (property == puncture_force) {
            QDir().mkpath(PALPATE_PICTURES);
            panel.grab().save(QString(PALPATE_PICTURES) + "/layers_curve_puncture.png");
        }
        press("remove_curve");
        settle();
        EXPECT_TRUE((*asked())[property].density.knots.empty()) << i;
        press("undo_layers");
        EXPECT_EQ((*asked())[property].density.knots.size(), 2U) << i;
        press("redo_layers");
    }
}

TEST_F(LayerCurves, each_property_has_a_factor_over_the_gradient_that_begins_is_changed_and_ends) {
    choose(1);
    auto* chart = find<LevelChart>("gradient_chart");
    auto* properties = find<QComboBox>("curve_property");
    EXPECT_FALSE(chart->isVisible());
    for (int i = 0; i < haptic_property_count; ++i) {
        const auto property = static_cast<HapticProperty>(i);
        properties->setFocus();
        while (properties->currentIndex() < i) QTest::keyClick(properties, Qt::Key_Down);
        settle();
        press("start_gradient");
        settle();
        ASSERT_TRUE(chart->isVisible());
        const Knots first = (*asked())[property].gradient.knots;
        ASSERT_EQ(first.size(), 1U) << i;
        EXPECT_EQ(first[0].value, 1) << "which changes nothing yet";
        chart->setFocus();
        for (const Qt::Key key : {Qt::Key_PageDown, Qt::Key_Insert, Qt::Key_Down, Qt::Key_Down}) {
            QTest::keyClick(chart, key);
        }
        settle();
        const Knots knots = (*asked())[property].gradient.knots;
        ASSERT_EQ(knots.size(), 2U) << i;
        EXPECT_LT(knots[1].value, 1) << i;
        EXPECT_GT(knots[1].at, knots[0].at) << i;
        EXPECT_TRUE((*asked())[property].density.knots.empty());
        EXPECT_NO_THROW(check(*asked(), Solid::above));
        if (property == stiffness) {
            QDir().mkpath(PALPATE_PICTURES);
            panel.grab().save(QString(PALPATE_PICTURES) + "/layers_curve_gradient.png");
        }
        press("remove_gradient");
        settle();
        EXPECT_TRUE((*asked())[property].gradient.knots.empty()) << i;
        EXPECT_FALSE(chart->isVisible());
        press("undo_layers");
        EXPECT_EQ((*asked())[property].gradient.knots.size(), 2U) << i;
        press("redo_layers");
    }
}

TEST_F(LayerCurves, a_curve_from_a_file_may_have_forces_that_are_infinite) {
    Layers layers = *choices[0].layers;
    const double never = std::numeric_limits<double>::infinity();
    layers[puncture_force].density.knots = {{-500, 1}, {1000, never}};
    choices[0].layers = std::make_shared<const Layers>(layers);
    panel.layers_controls().set_choices(choices);
    choose(1);
    auto* properties = find<QComboBox>("curve_property");
    properties->setFocus();
    while (properties->currentIndex() < int(puncture_force)) {
        QTest::keyClick(properties, Qt::Key_Down);
    }
    settle();
    const LevelChart& chart = panel.isovalue_controls().chart();
    ASSERT_EQ(chart.curve().knots.size(), 2U);
    EXPECT_TRUE(std::isfinite(chart.curve().top));
    EXPECT_EQ(chart.curve().knots[1].value, never);
    EXPECT_TRUE(find<QLabel>("curve_note")->text().contains("own") ||
                !std::ranges::all_of(layers.layers, [](const Layer& layer) {
                    return layer[puncture_force].has_value();
                }));
}

}  // namespace
}  // namespace palpate::viewer
