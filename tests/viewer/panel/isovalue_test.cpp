// The isovalue, set by mouse, wheel, keys and number.
#include "tests/viewer/panel/panel_fixture.hpp"

#include <QCheckBox>
#include <QComboBox>
#include <QSlider>
#include <QWheelEvent>

#include <cmath>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/window/isovalue_controls.hpp"

namespace palpate::viewer {
namespace {

class Isovalue : public PanelFixture {
  protected:
    Isovalue() { set(); }
    LevelChart* chart() { return find<LevelChart>("level_chart"); }
    /// A place in the plot over a level.
    QPointF over(double level) {
        return {chart()->axis().x_of(level), 0.5 * chart()->strip().top()};
    }
    std::vector<double> levels() {
        std::vector<double> found;
        for (const auto& one : of<command::Isovalue>()) found.push_back(one.isovalue);
        return found;
    }
    /// [data units] of a pixel.
    double pixel() {
        const LevelAxis axis = chart()->axis();
        return (axis.high - axis.low) / (axis.right - axis.left);
    }
    void wheel(QWidget* widget, int steps, Qt::KeyboardModifiers keys = Qt::NoModifier) {
        const QPointF at = QRectF(widget->rect()).center();
        QWheelEvent event(at, widget->mapToGlobal(at.toPoint()), {}, {0, 120 * steps}, Qt::NoButton,
                          keys, Qt::NoScrollPhase, false);
        QApplication::sendEvent(widget, &event);
    }
};

TEST_F(Isovalue, a_session_is_shown_and_nothing_is_asked_for) {
    RendererSettings settings;
    settings.force.stiffness = 0.7;
    const DensityRange ranges[] = {{-400, 150}, {700, 1500}};
    settings.penetrability = penetrability_ranges(1.5, ranges);
    set(settings, 412.5);
    set(settings, 300, Solid::below);
    set({}, 412.5);
    panel.look_controls().set_look({});
    panel.device_controls().list({});
    effect.observe({});
    settle();
    EXPECT_TRUE(commands.empty());
    EXPECT_EQ(find<NumberBox>("isovalue_box")->value(), 412.5);
    EXPECT_EQ(chart()->level(), 412.5);
}

TEST_F(Isovalue, dragging_the_line_asks_for_the_levels_under_the_pointer) {
    drag(chart(), over(300), over(1200));
    const std::vector<double> asked = levels();
    ASSERT_FALSE(asked.empty());
    for (std::size_t i = 1; i < asked.size(); ++i) EXPECT_GT(asked[i], asked[i - 1]);
    EXPECT_GE(asked.front(), 300);
    EXPECT_NEAR(asked.back(), 1200, pixel());
    EXPECT_EQ(effect.isovalue(), asked.back());
    EXPECT_EQ(find<NumberBox>("isovalue_box")->value(), asked.back());
}

TEST_F(Isovalue, the_first_level_of_a_drag_is_emitted_at_once_and_the_last_always) {
    drag(chart(), over(0), over(100), Qt::NoModifier, false);
    ASSERT_FALSE(commands.empty());  // without waiting
    for (int i = 1; i <= 500; ++i) move(chart(), over(100 + i));
    QTest::mouseRelease(chart(), Qt::LeftButton, {}, over(600).toPoint());
    EXPECT_NEAR(std::get<command::Isovalue>(commands.back()).isovalue, 600, pixel());
}

TEST_F(Isovalue, a_tick_of_a_suggested_level_is_taken_exactly) {
    const double suggested = run::suggested_isovalues(histogram).front();
    QTest::mouseClick(chart(), Qt::LeftButton, {},
                      QPoint(static_cast<int>(chart()->axis().x_of(suggested)), 2));
    ASSERT_EQ(levels().size(), 1U);
    EXPECT_EQ(levels().front(), suggested);
}

TEST_F(Isovalue, arrow_keys_and_wheel_step_finely_once_the_chart_has_the_focus) {
    panel.setFocus();
    wheel(chart(), 3);
    EXPECT_TRUE(levels().empty()) << "scrolling the panel must not change what is felt";
    chart()->setFocus();
    wheel(chart(), 2);
    EXPECT_EQ(levels().back(), 302);
    QTest::keyClick(chart(), Qt::Key_Left);
    EXPECT_EQ(levels().back(), 301);
    QTest::keyClick(chart(), Qt::Key_PageUp);
    EXPECT_EQ(levels().back(), 311);
    QTest::keyClick(chart(), Qt::Key_Home);
    EXPECT_EQ(levels().back(), -1000);
}

TEST_F(Isovalue, the_slider_covers_the_data_and_follows) {
    auto* slider = find<QSlider>("isovalue_slider");
    slider->setFocus();
    QTest::keyClick(slider, Qt::Key_End);
    EXPECT_EQ(levels().back(), chart()->axis().high);
    EXPECT_GE(levels().back(), 3000);
    type("isovalue_box", "1000");
    EXPECT_NEAR(double(slider->value()) / slider->maximum(), 2000 / (chart()->axis().high + 1000),
                1e-3);
}

TEST_F(Isovalue, a_typed_number_is_requested_as_it_is_even_outside_the_data) {
    type("isovalue_box", "123.4567891");
    EXPECT_EQ(levels(), (std::vector<double>{123.4567891}));
    // Another look at it, with fewer digits shown, changes nothing.
    QTest::keyClick(find<QWidget>("isovalue_box"), Qt::Key_Return);
    EXPECT_EQ(levels().size(), 1U);
    EXPECT_TRUE(find<QLabel>("isovalue_warning")->text().isEmpty());
    type("isovalue_box", "9000");
    EXPECT_EQ(levels().back(), 9000);
    EXPECT_TRUE(find<QLabel>("isovalue_warning")->text().contains("nothing to touch"));
}

TEST_F(Isovalue, a_text_that_is_no_number_is_not_accepted) {
    type("isovalue_box", "hello");
    type("isovalue_box", "-");
    type("isovalue_box", "nan");
    EXPECT_TRUE(levels().empty());
    EXPECT_EQ(find<NumberBox>("isovalue_box")->value(), 300);
}

TEST_F(Isovalue, random_numbers_come_back_from_the_box_unchanged) {
    std::mt19937_64 random(11);
    auto* box = find<NumberBox>("isovalue_box");
    for (int i = 0; i < 2000; ++i) {
        const double size = std::pow(10.0, std::uniform_real_distribution(-12.0, 12.0)(random));
        const double value = size * std::uniform_real_distribution(-1.0, 1.0)(random);
        box->show_value(value);
        ASSERT_EQ(box->value(), value);
        ASSERT_EQ(box->valueFromText(box->text()), value);  // Return on it changes nothing
        ASSERT_NEAR(box->text().toDouble(), value, 1e-6 * std::abs(value));
    }
    EXPECT_TRUE(levels().empty());
}

TEST_F(Isovalue, a_refused_level_goes_back_and_says_why) {
    refuse_with = "too many commands at once";
    type("isovalue_box", "700");
    EXPECT_EQ(levels().size(), 1U);
    EXPECT_EQ(find<NumberBox>("isovalue_box")->value(), 300);
    EXPECT_EQ(chart()->level(), 300);
    EXPECT_EQ(effect.isovalue(), 300);
    EXPECT_EQ(message("isovalue_part"), "too many commands at once");
    refuse_with.clear();
    type("isovalue_box", "800");
    EXPECT_EQ(message("isovalue_part"), "");
    EXPECT_EQ(effect.isovalue(), 800);
}

TEST_F(Isovalue, the_level_felt_is_a_second_marker_while_it_differs) {
    Snapshot now;
    now.session.tick.proxy.isovalue = 300;
    effect.observe(now);
    EXPECT_TRUE(std::isnan(chart()->felt()));
    now.penetrability_on = true;
    now.session.tick.proxy.isovalue = 640;
    effect.observe(now);
    EXPECT_EQ(chart()->felt(), 640);
    EXPECT_EQ(chart()->level(), 300);
    EXPECT_EQ(find<QLabel>("felt")->text(), "felt 640");
    now.session.tick.proxy.isovalue = std::numeric_limits<double>::infinity();
    effect.observe(now);
    EXPECT_EQ(find<QLabel>("felt")->text(), "felt inf");
}

TEST_F(Isovalue, the_other_side_and_another_field_are_felt_once_they_are_chosen) {
    feel("mouse");
    const auto choose = [&](const char* name, Qt::Key key) {
        auto* box = find<QComboBox>(name);
        box->setFocus();
        QTest::keyClick(box, key);
    };
    QSignalSpy replaced(&content, &Content::field_replaced);
    choose("solid", Qt::Key_Down);
    EXPECT_EQ(content.live()->field().solid(), Solid::below);
    EXPECT_EQ(content.live()->field().interpolation(), Interpolation::cubic);
    EXPECT_EQ(find<QComboBox>("solid")->currentIndex(), 1);
    choose("field", Qt::Key_Up);
    EXPECT_EQ(content.live()->field().solid(), Solid::below);
    EXPECT_EQ(content.live()->field().interpolation(), Interpolation::linear);
    choose("field", Qt::Key_Up);  // it is that one already
    EXPECT_EQ(replaced.count(), 2);
}

TEST_F(Isovalue, dequantizing_is_asked_for_and_shown_once_the_volume_has_been_read_again) {
    auto* box = find<QCheckBox>("dequantize");
    EXPECT_FALSE(box->isEnabled());
    std::vector<bool> wanted;
    IsovalueControls& controls = panel.isovalue_controls();
    QObject::connect(&controls, &IsovalueControls::dequantize_wanted,
                     [&](bool on) { wanted.push_back(on); });
    controls.set_dequantized(false, true, "the samples have two values");
    EXPECT_TRUE(find<QLabel>("terraces")->text().contains("the samples have two values"));
    box->click();
    EXPECT_EQ(wanted, std::vector{true});
    EXPECT_FALSE(box->isChecked());
    controls.set_dequantized(true, true, {});
    EXPECT_TRUE(box->isChecked());
    EXPECT_TRUE(find<QLabel>("terraces")->text().isEmpty());
    box->click();
    EXPECT_EQ(wanted, (std::vector{true, false}));
}

TEST_F(Isovalue, zoomed_in_a_pixel_is_less_and_the_slider_still_covers_all) {
    const LevelAxis whole = chart()->axis();
    const double coarse = pixel();
    wheel(chart(), 8, Qt::ControlModifier);
    EXPECT_TRUE(levels().empty());
    EXPECT_LT(pixel(), coarse / 5);
    const double middle = 0.5 * (chart()->axis().low + chart()->axis().high);
    QTest::mouseClick(chart(), Qt::LeftButton, {}, over(middle).toPoint());
    EXPECT_NEAR(levels().back(), middle, 1.5 * pixel());
    const double left = chart()->axis().low;
    wheel(chart(), 3, Qt::ShiftModifier);
    EXPECT_LT(chart()->axis().low, left);
    auto* slider = find<QSlider>("isovalue_slider");
    slider->setFocus();
    QTest::keyClick(slider, Qt::Key_Home);
    EXPECT_EQ(levels().back(), whole.low);
    chart()->setFocus();
    QTest::keyClick(chart(), Qt::Key_0, Qt::ControlModifier);
    EXPECT_EQ(chart()->axis().low, whole.low);
    EXPECT_EQ(chart()->axis().high, whole.high);
}

TEST_F(Isovalue, any_data_can_be_shown_and_stepped_through) {
    std::mt19937_64 random(8);
    for (int round = 0; round < 60; ++round) {
        const double size = std::pow(10.0, std::uniform_real_distribution(-30.0, 30.0)(random));
        const double shift = random() % 2 ? 0 : 1000 * size;
        std::vector<float> samples(1 + random() % 50);
        for (float& s : samples) {
            s = static_cast<float>(shift +
                                   size * std::uniform_real_distribution(-1.0, 1.0)(random));
        }
        Geometry geometry;
        geometry.size = {static_cast<int>(samples.size()), 1, 1};
        const Field data = linear_field(Volume(geometry, samples));
        begin(data, data.volume().minimum());
        commands.clear();
        chart()->setFocus();
        chart()->grab();
        QTest::keyClick(chart(), Qt::Key_End);
        QTest::keyClick(chart(), Qt::Key_PageDown);
        drag(chart(), {20, 30}, {200, 30});
        press("penetrability");
        press("add_range");
        chart()->grab();
        for (const double level : levels()) {
            ASSERT_GE(level, chart()->axis().low) << round;
            ASSERT_LE(level, chart()->axis().high) << round;
        }
        ASSERT_FALSE(levels().empty()) << round;
    }
}

TEST_F(Isovalue, without_a_volume_nothing_can_be_asked_for) {
    effect.end();
    drag(chart(), QPointF(50, 30), QPointF(200, 30));
    set();
    effect.end();
    QTest::mouseClick(chart(), Qt::LeftButton, {}, QPoint(80, 30));
    press("forces");
    QTest::keyClick(chart(), Qt::Key_Right);
    effect.observe({});
    settle();
    EXPECT_TRUE(commands.empty());
}

TEST_F(Isovalue, clearing_in_the_middle_of_a_drag_is_safe) {
    drag(chart(), over(300), over(900), Qt::NoModifier, false);
    effect.end();
    const std::size_t before = commands.size();
    QTest::mouseRelease(chart(), Qt::LeftButton, {}, over(900).toPoint());
    settle();
    EXPECT_EQ(commands.size(), before);
}

}  // namespace
}  // namespace palpate::viewer
