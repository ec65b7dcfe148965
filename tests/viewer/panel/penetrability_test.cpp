// Pressing through, set by bands on the histogram and by the numbers of their ends.
#include "tests/viewer/panel/panel_fixture.hpp"

#include <QCheckBox>
#include <QContextMenuEvent>
#include <QMenu>
#include <QPushButton>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/level_chart.hpp"

namespace palpate::viewer {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

class Pressing : public PanelFixture {
  protected:
    LevelChart* chart() { return find<LevelChart>("level_chart"); }
    /// Rows of ranges that are shown.
    int rows() {
        int count = 0;
        for (int i = 1; i <= 16; ++i) count += find<QWidget>(range(i, "low"))->isVisible();
        return count;
    }
    static const char* range(int number, const char* part) {
        static std::string name;
        name = "range_" + std::to_string(number) + "_" + part;
        return name.c_str();
    }
    QPointF over(double level) {
        return {chart()->axis().x_of(level), 0.5 * chart()->strip().top()};
    }
    QPointF on_strip(double level) {
        return {chart()->axis().x_of(level), chart()->strip().center().y()};
    }
    double pixel() {
        const LevelAxis axis = chart()->axis();
        return (axis.high - axis.low) / (axis.right - axis.left);
    }
    void set_ranges(Ranges ranges, Solid solid = Solid::above) {
        RendererSettings settings;
        settings.penetrability = penetrability_ranges(1.5, ranges, solid);
        set(settings, 300, solid);
    }
    Penetrability last() {
        const auto all = of<Penetrability>();
        EXPECT_FALSE(all.empty());
        return all.empty() ? Penetrability{} : all.back();
    }
    static void expect_range(const Penetrability& p, int at, double low, double high,
                             double within) {
        ASSERT_LT(at, p.range_count);
        EXPECT_NEAR(p.ranges[static_cast<std::size_t>(at)].low, low, within);
        EXPECT_NEAR(p.ranges[static_cast<std::size_t>(at)].high, high, within);
    }
};

TEST_F(Pressing, begins_at_the_isovalue_without_an_end_and_takes_pt_and_a_minimum) {
    set();
    EXPECT_EQ(rows(), 0);
    press("penetrability");
    ASSERT_EQ(of<Penetrability>().size(), 1U);
    EXPECT_TRUE(last().on);
    EXPECT_EQ(last().threshold, 1);
    EXPECT_EQ(last().range_count, 1);
    EXPECT_EQ(last().ranges[0].low, 300);
    EXPECT_EQ(last().ranges[0].high, infinity);
    type("threshold_box", "2.25");
    EXPECT_EQ(last().threshold, 2.25);
    type(range(1, "low"), "-200");
    EXPECT_EQ(last().ranges[0].low, -200);
    EXPECT_EQ(last().threshold, 2.25);
    EXPECT_TRUE(find<QLabel>("isovalue_overruled")->isVisible());
    press("penetrability");
    EXPECT_FALSE(find<QLabel>("isovalue_overruled")->isVisible());
    press("penetrability");
    EXPECT_EQ(last().ranges[0].low, -200) << "it is kept";
}

TEST_F(Pressing, the_minimum_is_the_end_of_the_band_and_is_dragged_there) {
    set();
    press("penetrability");
    drag(chart(), on_strip(300), on_strip(700));
    EXPECT_NEAR(last().ranges[0].low, 700, pixel());
    EXPECT_EQ(last().ranges[0].high, infinity);
    EXPECT_TRUE(of<command::Isovalue>().empty()) << "the level is not what was dragged";
    drag(chart(), on_strip(1500), on_strip(1800));  // the whole: what has no end keeps none
    EXPECT_NEAR(last().ranges[0].low, 1000, 2 * pixel());
    EXPECT_EQ(last().ranges[0].high, infinity);
}

TEST_F(Pressing, where_below_is_solid_the_minimum_is_a_maximum) {
    set({}, 300, Solid::below);
    press("penetrability");
    EXPECT_EQ(last().ranges[0].low, -infinity);
    EXPECT_EQ(last().ranges[0].high, 300);
    EXPECT_NO_THROW(check(last(), Solid::below));
}

TEST_F(Pressing, a_range_drawn_in_one_without_an_end_takes_its_place) {
    set();
    press("penetrability");
    drag(chart(), over(500), over(900), Qt::ShiftModifier);
    ASSERT_EQ(last().range_count, 1);
    expect_range(last(), 0, 500, 900, 1.5 * pixel());
    type(range(1, "high"), "inf");
    drag(chart(), over(-600), over(-100), Qt::ShiftModifier);  // outside of it
    EXPECT_EQ(last().range_count, 2);
}

TEST_F(Pressing, shift_drag_makes_a_range_and_switches_pressing_through_on) {
    set();
    drag(chart(), over(500), over(900), Qt::ShiftModifier);
    ASSERT_EQ(last().range_count, 1);
    EXPECT_TRUE(last().on);
    expect_range(last(), 0, 500, 900, 1.5 * pixel());
    EXPECT_TRUE(find<QCheckBox>("penetrability")->isChecked());
    drag(chart(), over(-100), over(-600), Qt::ShiftModifier);  // either way
    ASSERT_EQ(last().range_count, 2);
    expect_range(last(), 0, -600, -100, 1.5 * pixel());
    EXPECT_EQ(rows(), 2);
    EXPECT_TRUE(of<command::Isovalue>().empty());
}

TEST_F(Pressing, bands_are_moved_and_resized_by_their_strip) {
    set_ranges({{-400, 100}, {700, 1500}});
    drag(chart(), on_strip(1100), on_strip(1400));  // the whole
    expect_range(last(), 1, 1000, 1800, 1.5 * pixel());
    expect_range(last(), 0, -400, 100, 0);
    drag(chart(), on_strip(-400), on_strip(-800));  // an end
    expect_range(last(), 0, -800, 100, 1.5 * pixel());
    EXPECT_EQ(last().threshold, 1.5);
}

TEST_F(Pressing, a_band_drawn_over_another_becomes_one_with_it_when_it_is_let_go) {
    set_ranges({{-400, 100}, {700, 1500}});
    drag(chart(), on_strip(700), on_strip(0), Qt::NoModifier, false);
    EXPECT_EQ(rows(), 2);
    QTest::mouseRelease(chart(), Qt::LeftButton, {}, on_strip(0).toPoint());
    ASSERT_EQ(last().range_count, 1);
    expect_range(last(), 0, -400, 1500, 0);
    EXPECT_EQ(rows(), 1);
}

TEST_F(Pressing, del_on_a_chosen_band_deletes_it_but_not_the_last) {
    set_ranges({{-400, 100}, {700, 1500}});
    QTest::mouseClick(chart(), Qt::LeftButton, {}, on_strip(1000).toPoint());
    QTest::keyClick(chart(), Qt::Key_Delete);
    ASSERT_EQ(last().range_count, 1);
    expect_range(last(), 0, -400, 100, 0);
    const auto before = of<Penetrability>().size();
    QTest::mouseClick(chart(), Qt::LeftButton, {}, on_strip(-200).toPoint());
    QTest::keyClick(chart(), Qt::Key_Delete);
    EXPECT_EQ(of<Penetrability>().size(), before);
    EXPECT_TRUE(message("penetrability_part").contains("last range"));
}

TEST_F(Pressing, del_deletes_no_band_once_something_else_was_pressed) {
    set_ranges({{-400, 100}, {700, 1500}});
    QTest::mouseClick(chart(), Qt::LeftButton, {}, on_strip(1000).toPoint());
    QTest::mouseClick(chart(), Qt::LeftButton, {}, over(600).toPoint());
    QTest::keyClick(chart(), Qt::Key_Delete);
    EXPECT_EQ(chart()->bands().size(), 2U);
    EXPECT_TRUE(of<Penetrability>().empty());
}

TEST_F(Pressing, a_right_click_on_a_band_offers_to_delete_it) {
    set_ranges({{-400, 100}, {700, 1500}});
    const QPoint at = on_strip(0).toPoint();
    QContextMenuEvent click(QContextMenuEvent::Mouse, at, chart()->mapToGlobal(at));
    QApplication::sendEvent(chart(), &click);
    auto* menu = chart()->findChild<QMenu*>();
    ASSERT_NE(menu, nullptr);
    EXPECT_EQ(menu->actions().front()->text(), "Delete range -400 to 100");
    menu->actions().front()->trigger();
    menu->close();
    ASSERT_EQ(last().range_count, 1);
    expect_range(last(), 0, 700, 1500, 0);
}

TEST_F(Pressing, ends_take_numbers_and_infinity) {
    set_ranges({{-400, 100}, {700, 1500}});
    type(range(2, "high"), "inf");
    expect_range(last(), 1, 700, 700, infinity);
    EXPECT_EQ(last().ranges[1].high, infinity);
    type(range(1, "low"), "-412.5");
    EXPECT_EQ(last().ranges[0].low, -412.5);
    EXPECT_EQ(of<Penetrability>().size(), 2U);
}

TEST_F(Pressing, where_below_is_solid_ranges_go_out_in_falling_order) {
    set_ranges({{-400, 100}, {700, 1500}}, Solid::below);
    type(range(2, "low"), "600");
    EXPECT_EQ(last().ranges[0].low, 600);
    EXPECT_EQ(last().ranges[1].low, -400);
    EXPECT_NO_THROW(check(last(), Solid::below));
}

TEST_F(Pressing, invalid_settings_are_refused_and_emit_nothing) {
    set_ranges({{-400, 100}, {700, 1500}});
    type(range(1, "low"), "skin");
    type(range(1, "low"), "5000");  // above its end
    EXPECT_TRUE(message("penetrability_part").contains("low <= high"));
    type("threshold_box", "-1");
    EXPECT_TRUE(message("penetrability_part").contains("at least 0"));
    EXPECT_TRUE(of<Penetrability>().empty());
    EXPECT_EQ(find<NumberBox>(range(1, "low"))->value(), -400);
    EXPECT_EQ(chart()->bands()[0].low, -400);
}

TEST_F(Pressing, sixteen_ranges_fit_and_a_seventeenth_is_refused) {
    Ranges ranges;
    for (int i = 0; i < 15; ++i) ranges.push_back({-900.0 + 200 * i, -800.0 + 200 * i});
    set_ranges(ranges);
    press("add_range");
    EXPECT_EQ(last().range_count, 16);
    press("add_range");
    EXPECT_EQ(of<Penetrability>().size(), 1U);
    EXPECT_EQ(rows(), 16);
    EXPECT_TRUE(message("penetrability_part").contains("more than 16"));
}

TEST_F(Pressing, added_ranges_never_touch_those_that_are_there_and_each_can_be_removed) {
    set();
    press("penetrability");
    EXPECT_FALSE(find<QWidget>(range(1, "remove"))->isEnabled()) << "the last one stays";
    for (int i = 0; i < 10; ++i) press("add_range");
    EXPECT_EQ(last().range_count, 11);
    press(range(4, "remove"));
    EXPECT_EQ(last().range_count, 10);
    EXPECT_EQ(rows(), 10);
}

TEST_F(Pressing, switched_off_the_isovalue_that_was_chosen_counts_again) {
    set_ranges({{-400, 1500}});
    Snapshot now;
    now.penetrability_on = true;
    now.session.tick.proxy.isovalue = 812;
    effect.observe(now);
    const double chosen = effect.isovalue();
    press("penetrability");
    EXPECT_FALSE(last().on);
    ASSERT_EQ(of<command::Isovalue>().size(), 1U);
    EXPECT_EQ(of<command::Isovalue>().back().isovalue, chosen);
}

TEST_F(Pressing, a_refusal_shows_the_old_ranges_again) {
    set_ranges({{-400, 100}, {700, 1500}});
    refuse_with = "not now";
    type(range(1, "low"), "-500");
    EXPECT_EQ(find<NumberBox>(range(1, "low"))->value(), -400);
    press("penetrability");
    EXPECT_TRUE(find<QCheckBox>("penetrability")->isChecked());
    EXPECT_EQ(message("penetrability_part"), "not now");
    EXPECT_TRUE(of<command::Isovalue>().empty());
}

TEST(RangeBands, a_dragged_range_stays_a_range_within_the_axis) {
    std::mt19937_64 random(9);
    const LevelAxis axis{-100, 300, 10, 210};
    std::uniform_real_distribution<double> level(-100, 300);
    for (int round = 0; round < 5000; ++round) {
        const double a = level(random);
        const double b = level(random);
        const DensityRange start{std::min(a, b), std::max(a, b)};
        const double held = level(random);
        const double to = level(random);
        const auto grip = static_cast<Grip>(random() % 3);
        const DensityRange moved = dragged(start, grip, held, to, axis);
        ASSERT_LE(moved.low, moved.high);
        ASSERT_GE(moved.low, axis.low - 1e-9);
        ASSERT_LE(moved.high, axis.high + 1e-9);
        if (grip == Grip::whole) {
            ASSERT_NEAR(moved.high - moved.low, start.high - start.low, 1e-9);
        }
    }
}

}  // namespace
}  // namespace palpate::viewer
