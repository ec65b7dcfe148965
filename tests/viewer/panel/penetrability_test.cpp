// Pressing through, set by bands on the histogram, by the table and by modes.
#include "tests/viewer/panel/panel_fixture.hpp"

#include <QContextMenuEvent>
#include <QLineEdit>
#include <QMenu>
#include <QPushButton>
#include <QRadioButton>

#include <algorithm>
#include <cmath>

#include "apps/viewer/panel/level_chart.hpp"
#include "apps/viewer/panel/penetrability_controls.hpp"

namespace palpate::viewer {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

class Pressing : public PanelFixture {
  protected:
    LevelChart* chart() { return find<LevelChart>("level_chart"); }
    RangeTable* table() { return find<RangeTable>("ranges"); }
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
    void type_cell(int row, int column, const QString& text) {
        table()->setCurrentCell(row, column);
        table()->editItem(table()->item(row, column));
        auto* editor = table()->findChild<QLineEdit*>();
        ASSERT_NE(editor, nullptr);
        editor->selectAll();
        QTest::keyClicks(editor, text);
        QTest::keyClick(editor, Qt::Key_Return);
        // A table takes it, and the editor goes, a little later.
        wait_until([this] { return !table()->findChild<QLineEdit*>(); });
    }
    static void expect_range(const Penetrability& p, int at, double low, double high,
                             double within) {
        ASSERT_LT(at, p.range_count);
        EXPECT_NEAR(p.ranges[static_cast<std::size_t>(at)].low, low, within);
        EXPECT_NEAR(p.ranges[static_cast<std::size_t>(at)].high, high, within);
    }
};

TEST_F(Pressing, threshold_begins_at_the_isovalue_and_takes_pt_and_minimum) {
    set();
    press("penetrability_threshold");
    ASSERT_EQ(of<Penetrability>().size(), 1U);
    EXPECT_TRUE(last().on);
    EXPECT_EQ(last().threshold, 1);
    expect_range(last(), 0, 300, 300, infinity);
    EXPECT_EQ(last().ranges[0].low, 300);
    EXPECT_EQ(last().ranges[0].high, infinity);
    type("threshold_box", "2.25");
    EXPECT_EQ(last().threshold, 2.25);
    type("minimum", "-200");
    EXPECT_EQ(last().ranges[0].low, -200);
    EXPECT_EQ(last().threshold, 2.25);
    EXPECT_TRUE(find<QLabel>("isovalue_overruled")->isVisible());
    press("penetrability_off");
    EXPECT_FALSE(find<QLabel>("isovalue_overruled")->isVisible());
}

TEST_F(Pressing, the_minimum_is_the_end_of_the_band_and_is_dragged_there) {
    set();
    press("penetrability_threshold");
    drag(chart(), on_strip(300), on_strip(700));
    EXPECT_NEAR(last().ranges[0].low, 700, pixel());
    EXPECT_EQ(last().ranges[0].high, infinity);
    EXPECT_TRUE(of<command::Isovalue>().empty()) << "the level is not what was dragged";
    // The band itself is not moved, nor deleted.
    const auto before = of<Penetrability>().size();
    drag(chart(), on_strip(1500), on_strip(1800));
    chart()->choose_band(0);
    chart()->setFocus();
    QTest::keyClick(chart(), Qt::Key_Delete);
    EXPECT_EQ(of<Penetrability>().size(), before);
}

TEST_F(Pressing, where_below_is_solid_the_minimum_is_a_maximum) {
    set({}, 300, Solid::below);
    press("penetrability_threshold");
    EXPECT_EQ(last().ranges[0].low, -infinity);
    EXPECT_EQ(last().ranges[0].high, 300);
    EXPECT_NO_THROW(check(last(), Solid::below));
}

TEST_F(Pressing, shift_drag_makes_a_range_and_switches_ranges_on) {
    set();
    drag(chart(), over(500), over(900), Qt::ShiftModifier);
    ASSERT_EQ(last().range_count, 1);
    EXPECT_TRUE(last().on);
    expect_range(last(), 0, 500, 900, 1.5 * pixel());
    EXPECT_TRUE(find<QRadioButton>("penetrability_ranges")->isChecked());
    drag(chart(), over(-100), over(-600), Qt::ShiftModifier);  // either way
    ASSERT_EQ(last().range_count, 2);
    expect_range(last(), 0, -600, -100, 1.5 * pixel());
    EXPECT_EQ(table()->rowCount(), 2);
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
    EXPECT_EQ(table()->rowCount(), 2);
    QTest::mouseRelease(chart(), Qt::LeftButton, {}, on_strip(0).toPoint());
    ASSERT_EQ(last().range_count, 1);
    expect_range(last(), 0, -400, 1500, 0);
    EXPECT_EQ(table()->rowCount(), 1);
}

TEST_F(Pressing, del_on_a_chosen_band_deletes_it_but_not_the_last) {
    set_ranges({{-400, 100}, {700, 1500}});
    QTest::mouseClick(chart(), Qt::LeftButton, {}, on_strip(1000).toPoint());
    EXPECT_EQ(table()->chosen(), 1);
    QTest::keyClick(chart(), Qt::Key_Delete);
    ASSERT_EQ(last().range_count, 1);
    expect_range(last(), 0, -400, 100, 0);
    const auto before = of<Penetrability>().size();
    QTest::mouseClick(chart(), Qt::LeftButton, {}, on_strip(-200).toPoint());
    QTest::keyClick(chart(), Qt::Key_Delete);
    EXPECT_EQ(of<Penetrability>().size(), before);
    EXPECT_TRUE(message("penetrability_part").contains("last range"));
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

TEST_F(Pressing, the_table_takes_numbers_and_infinity) {
    set_ranges({{-400, 100}, {700, 1500}});
    type_cell(1, 1, "inf");
    expect_range(last(), 1, 700, 700, infinity);
    EXPECT_EQ(last().ranges[1].high, infinity);
    type_cell(0, 0, "-412.5");
    EXPECT_EQ(last().ranges[0].low, -412.5);
    EXPECT_EQ(of<Penetrability>().size(), 2U);
}

TEST_F(Pressing, where_below_is_solid_ranges_go_out_in_falling_order) {
    set_ranges({{-400, 100}, {700, 1500}}, Solid::below);
    type_cell(1, 0, "600");
    EXPECT_EQ(last().ranges[0].low, 600);
    EXPECT_EQ(last().ranges[1].low, -400);
    EXPECT_NO_THROW(check(last(), Solid::below));
}

TEST_F(Pressing, invalid_settings_are_refused_and_emit_nothing) {
    set_ranges({{-400, 100}, {700, 1500}});
    type_cell(0, 0, "skin");
    EXPECT_TRUE(message("penetrability_part").contains("not a number"));
    type_cell(0, 0, "nan");
    EXPECT_TRUE(message("penetrability_part").contains("not a number"));
    type_cell(0, 0, "5000");  // above its end
    EXPECT_TRUE(message("penetrability_part").contains("low <= high"));
    type("threshold_box", "-1");
    EXPECT_TRUE(message("penetrability_part").contains("at least 0"));
    EXPECT_TRUE(of<Penetrability>().empty());
    EXPECT_EQ(table()->item(0, 0)->text(), "-400");
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
    EXPECT_EQ(table()->rowCount(), 16);
    EXPECT_TRUE(message("penetrability_part").contains("more than 16"));
}

TEST_F(Pressing, added_ranges_never_touch_those_that_are_there) {
    set();
    press("penetrability_ranges");
    for (int i = 0; i < 10; ++i) press("add_range");
    EXPECT_EQ(last().range_count, 11);
    press("delete_range");
    EXPECT_TRUE(message("penetrability_part").contains("choose"));
    table()->selectRow(3);
    press("delete_range");
    EXPECT_EQ(last().range_count, 10);
}

TEST_F(Pressing, switched_off_the_isovalue_that_was_chosen_counts_again) {
    set_ranges({{-400, 1500}});
    Snapshot now;
    now.penetrability_on = true;
    now.session.tick.proxy.isovalue = 812;
    effect.observe(now);
    const double chosen = effect.isovalue();
    press("penetrability_off");
    EXPECT_FALSE(last().on);
    ASSERT_EQ(of<command::Isovalue>().size(), 1U);
    EXPECT_EQ(of<command::Isovalue>().back().isovalue, chosen);
}

TEST_F(Pressing, a_refusal_shows_the_old_ranges_again) {
    set_ranges({{-400, 100}, {700, 1500}});
    refuse_with = "not now";
    type_cell(0, 0, "-500");
    EXPECT_EQ(table()->item(0, 0)->text(), "-400");
    press("penetrability_off");
    EXPECT_TRUE(find<QRadioButton>("penetrability_ranges")->isChecked());
    EXPECT_EQ(message("penetrability_part"), "not now");
    EXPECT_TRUE(of<command::Isovalue>().empty());
}

TEST(PressThrough, settings_come_back_from_the_panel_unchanged) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> level(-1000, 1000);
    for (int round = 0; round < 2000; ++round) {
        const Solid solid = random() % 2 ? Solid::above : Solid::below;
        Penetrability p = penetrability_threshold(std::abs(level(random)), level(random), solid);
        if (random() % 2) {
            Ranges ranges(1 + random() % 16);
            for (DensityRange& range : ranges) {
                range.low = level(random);
                range.high = random() % 8 ? range.low + 50 : infinity;
            }
            p = penetrability_ranges(1, ranges, solid);
        }
        const PressThrough shown = shown_from(p, solid, first_press_through(0, -1000, 1000, solid));
        const Penetrability back =
            penetrability_of(with_bands(shown, bands_of(shown, solid), solid), solid);
        ASSERT_EQ(back.on, p.on);
        ASSERT_EQ(back.threshold, p.threshold);
        ASSERT_EQ(back.range_count, p.range_count);
        for (int i = 0; i < p.range_count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            ASSERT_EQ(back.ranges[at].low, p.ranges[at].low);
            ASSERT_EQ(back.ranges[at].high, p.ranges[at].high);
        }
    }
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
        const auto grip = static_cast<Grip>(1 + random() % 3);
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
