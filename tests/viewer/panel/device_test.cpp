// Devices, the servo loop, the switch of hands, and tools in the panel.
#include <QComboBox>
#include <QLineEdit>
#include <QPushButton>
#include <QToolButton>

#include "apps/viewer/panel/device_controls.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/panel/session_bar.hpp"
#include "apps/viewer/panel/tool_controls.hpp"
#include "tests/viewer/panel/panel_fixture.hpp"
#include "viewer/panel/panel_fixture.hpp"

namespace palpate::viewer {
namespace {

const std::vector<devices::DeviceFinding> findings{
    {"simulated", true, "a device and its hand, computed", "", "seed=1"},
    {"mouse", true, "pointer and keys", "", "speed=600 [mm/s]"},
    {"haply", false, "", "no Inverse Service at localhost:10001", "host=localhost,port=10001"}};

class Devices : public PanelFixture {
  protected:
    Devices() {
        QObject::connect(&panel.device_controls(), &DeviceControls::chosen,
                         [this](const QString& option) { chosen.push_back(option); });
    }
    QComboBox* picker() { return find<QComboBox>("devices"); }
    QStringList chosen;
};

TEST_F(Devices, the_device_in_use_is_shown_with_its_options) {
    set();
    panel.device_controls().set_devices(findings, "simulated:seed=7,depth=3");
    EXPECT_TRUE(picker()->currentText().startsWith("simulated"));
    EXPECT_EQ(find<QLineEdit>("device_options")->text(), "seed=7,depth=3");
    EXPECT_TRUE(chosen.empty());
}

TEST_F(Devices, connecting_asks_for_name_and_options) {
    set();
    panel.device_controls().set_devices(findings, "simulated");
    picker()->setFocus();
    QTest::keyClick(picker(), Qt::Key_Down);
    press("connect_device");
    auto* options = find<QLineEdit>("device_options");
    EXPECT_EQ(options->placeholderText(), "speed=600 [mm/s]");
    options->setFocus();
    QTest::keyClicks(options, "speed=300");
    QTest::keyClick(options, Qt::Key_Return);
    EXPECT_EQ(chosen, (QStringList{"mouse", "mouse:speed=300"}));
}

TEST_F(Devices, a_device_that_was_not_found_says_why_and_can_be_tried_elsewhere) {
    set();
    panel.device_controls().set_devices(findings, "simulated");
    const int haply = picker()->findText("haply", Qt::MatchStartsWith);
    ASSERT_GE(haply, 0);
    EXPECT_EQ(picker()->itemData(haply, Qt::ToolTipRole).toString(),
              "no Inverse Service at localhost:10001");
    EXPECT_EQ(picker()->itemData(haply, Qt::ForegroundRole).value<QBrush>().color(),
              picker()->palette().color(QPalette::Disabled, QPalette::Text));
    picker()->setFocus();
    QTest::keyClick(picker(), Qt::Key_End);
    EXPECT_EQ(find<QLabel>("device_missing")->text(), "no Inverse Service at localhost:10001");
    QTest::keyClicks(find<QLineEdit>("device_options"), "host=10.0.0.7");
    press("connect_device");
    EXPECT_EQ(chosen, (QStringList{"haply:host=10.0.0.7"}));
}

TEST_F(Devices, simulated_and_mouse_are_always_there) {
    set();
    panel.device_controls().set_devices({}, "");
    EXPECT_GE(picker()->findText("simulated", Qt::MatchStartsWith), 0);
    EXPECT_GE(picker()->findText("mouse", Qt::MatchStartsWith), 0);
    panel.device_controls().set_devices(findings, "mouse");
    EXPECT_EQ(picker()->count(), 3);
    EXPECT_TRUE(picker()->currentText().startsWith("mouse"));
}

TEST_F(Devices, invalid_options_are_refused_in_the_panel) {
    set();
    panel.device_controls().set_devices(findings, "mouse");
    QTest::keyClicks(find<QLineEdit>("device_options"), "speed=1,speed=2");
    press("connect_device");
    EXPECT_TRUE(chosen.empty());
    EXPECT_TRUE(message("device_part").contains("speed"));
}

TEST_F(Devices, an_unavailable_device_leaves_the_old_one) {
    set();
    panel.device_controls().set_devices(findings, "simulated:seed=7");
    picker()->setFocus();
    QTest::keyClick(picker(), Qt::Key_Down);
    press("connect_device");
    EXPECT_EQ(chosen.size(), 1);
    panel.device_controls().set_devices(findings, "simulated:seed=7");
    EXPECT_TRUE(picker()->currentText().startsWith("simulated"));
    EXPECT_EQ(find<QLineEdit>("device_options")->text(), "seed=7");
}

TEST_F(Devices, the_button_requests_a_new_search) {
    set();
    QSignalSpy wanted(&panel.device_controls(), &DeviceControls::refresh_wanted);
    press("refresh_devices");
    EXPECT_EQ(wanted.count(), 1);
}

TEST_F(Devices, the_device_state_is_shown_with_what_to_do) {
    set();
    DeviceInfo info = desktop_device();
    info.name = "haply";
    info.model = "Inverse3 0A1B";
    info.workspace_low = Vec3(-70, 0, -50);
    info.workspace_high = Vec3(70, 100, 50);
    info.limits.maximum_force = 4;
    panel.device_controls().show_device(info, DeviceStatus::uncalibrated,
                                        "move the arm to its corner");
    EXPECT_EQ(find<QLabel>("device_state")->text(), "needs calibration");
    EXPECT_EQ(find<QLabel>("device_problem")->text(), "move the arm to its corner");
    EXPECT_TRUE(find<QLabel>("device_problem")->isVisible());
    EXPECT_EQ(find<QLabel>("device_model")->text(), "haply, Inverse3 0A1B");
    EXPECT_EQ(find<QLabel>("device_workspace")->text(), "140 x 100 x 100 mm, up to 4 N");
    const QColor amber = find<QLabel>("device_dot")->palette().color(QPalette::WindowText);
    panel.device_controls().show_device(info, DeviceStatus::ready, {});
    EXPECT_FALSE(find<QLabel>("device_problem")->isVisible());
    EXPECT_NE(find<QLabel>("device_dot")->palette().color(QPalette::WindowText), amber);
    Snapshot now;
    now.session.device.status = DeviceStatus::lost;
    effect.observe(now);
    EXPECT_EQ(find<QLabel>("device_state")->text(), "connection lost");
}

TEST_F(Devices, the_scale_of_the_hand_is_requested_and_followed) {
    set();
    type("scale", "2.5");
    ASSERT_EQ(of<command::Scale>().size(), 1U);
    EXPECT_EQ(of<command::Scale>().back().scale, 2.5);
    type("scale", "0");
    type("scale", "-3");
    EXPECT_EQ(of<command::Scale>().size(), 1U);
    EXPECT_NE(message("device_part"), "");
    panel.setFocus();
    Snapshot now;
    effect.observe(now);
    EXPECT_EQ(find<NumberBox>("scale")->value(), 2.5) << "the snapshot is older";
    for (const double scale : {2.5, 1.75}) {
        now.session.transform.scale = scale;
        effect.observe(now);
        EXPECT_EQ(find<NumberBox>("scale")->value(), scale);
    }
    EXPECT_EQ(of<command::Scale>().size(), 1U);
}

TEST_F(Devices, the_loops_figures_are_shown_with_their_units) {
    set();
    ServoReport report;
    report.ticks = 5000;
    report.missed = 3;
    report.overruns = 1;
    report.lateness = {5000, 12000, 40000, 150000, 2100000};
    report.compute = {5000, 800, 2500, 6000, 30000};
    report.worst = {17, 2100000, 50000, 30000, TickCause::machine};
    panel.loop_view().show_report(report, 998.6);
    EXPECT_EQ(find<QLabel>("loop_rate")->text(), "999 Hz");
    EXPECT_EQ(find<QLabel>("loop_missed")->text(), "3 of 5003 ticks, 1 forces taken back");
    EXPECT_EQ(find<QLabel>("lateness_p50")->text(), "12 µs");
    EXPECT_EQ(find<QLabel>("lateness_p999")->text(), "150 µs");
    EXPECT_EQ(find<QLabel>("lateness_max")->text(), "2.1 ms");
    EXPECT_EQ(find<QLabel>("compute_p50")->text(), "800 ns");
    EXPECT_EQ(find<QLabel>("compute_p99")->text(), "2.5 µs");
    EXPECT_EQ(find<QLabel>("loop_worst")->text(), "2.15 ms, mostly the machine");
}

TEST_F(Devices, sections_fold_away_and_open_to_say_what_was_refused) {
    set();
    auto* part = find<Section>("force_part");
    auto* heading = find<QToolButton>("force_part_heading");
    QTest::mouseClick(heading, Qt::LeftButton);
    EXPECT_FALSE(part->is_open());
    EXPECT_FALSE(find<QWidget>("stiffness")->isVisible());
    panel.findChild<NumberBox*>("stiffness_box")->setValue(99);
    EXPECT_TRUE(part->is_open());
    EXPECT_TRUE(message("force_part").contains("stiffness"));
    heading->setFocus();
    QTest::keyClick(heading, Qt::Key_Return);
    EXPECT_FALSE(part->is_open());
}

class HandsOfPanel : public PanelFixture {
  protected:
    HandsOfPanel() {
        QObject::connect(&hands(), &HandSwitch::wanted,
                         [this](int hand) { wanted.push_back(hand); });
    }
    HandSwitch& hands() { return panel.hand_switch(); }
    std::vector<int> wanted;
};

TEST_F(HandsOfPanel, one_hand_needs_no_switch_and_two_are_told_apart_by_words_and_colour) {
    set();
    hands().show_hands({{"mouse", {}}}, 1);
    EXPECT_FALSE(hands().isVisible());
    hands().show_hands({{"mouse", {}}, {"haply", {}}}, 2);
    EXPECT_TRUE(hands().isVisible());
    auto *one = find<QPushButton>("hand_1"), *two = find<QPushButton>("hand_2");
    EXPECT_FALSE(one->isChecked());
    EXPECT_TRUE(two->isChecked());
    EXPECT_EQ(two->text(), "Hand 2: haply");
    EXPECT_EQ(two->accessibleName(), "Settings of hand 2, haply");
    const auto colour_of = [](QPushButton* button) {
        return QColor(button->grab().toImage().pixel(6, button->height() / 2));
    };
    const QColor second = colour_of(two);
    hands().show_hands({{"mouse", {}}, {"haply", "lost: check the cable"}}, 1);
    EXPECT_NE(colour_of(two), second);
    EXPECT_NE(colour_of(one), second);
    EXPECT_TRUE(two->text().startsWith(QString::fromUtf8("\u26A0")));
    EXPECT_EQ(two->accessibleDescription(), "lost: check the cable");
    EXPECT_TRUE(wanted.empty());
}

TEST_F(HandsOfPanel, the_other_hand_is_chosen_by_mouse_and_keys) {
    set();
    hands().show_hands({{"mouse", {}}, {"haply", {}}}, 1);
    press("hand_2");
    EXPECT_EQ(wanted, std::vector{2});
    find<QPushButton>("hand_2")->setFocus();
    QTest::keyClick(find<QPushButton>("hand_2"), Qt::Key_Left);
    EXPECT_EQ(wanted, (std::vector{2, 1}));
}

TEST_F(HandsOfPanel, a_hand_is_added_with_the_device_that_is_chosen_and_removed) {
    set();
    QSignalSpy added(&panel.device_controls(), &DeviceControls::added);
    QSignalSpy removed(&panel.device_controls(), &DeviceControls::removed);
    panel.device_controls().set_devices({}, "simulated:seed=3");
    EXPECT_FALSE(find<QPushButton>("remove_hand")->isVisible());
    press("add_hand");
    ASSERT_EQ(added.count(), 1);
    EXPECT_EQ(added.front().front().toString(), "simulated:seed=3");
    panel.device_controls().set_hands(2);
    EXPECT_FALSE(find<QPushButton>("add_hand")->isVisible());
    press("remove_hand");
    EXPECT_EQ(removed.count(), 1);
}

class PanelTool : public PanelFixture {
  protected:
    PanelTool() {
        RendererSettings settings;
        set(settings);
    }
    /// As PanelFixture::set, on the smooth field, which tools need.
    void set_smooth(const RendererSettings& settings) {
        session_settings = settings;
        field.emplace(head_like(), Solid::above, std::nullopt, Interpolation::cubic);
        begin(*field, 300, settings);
    }
    void choose(int row) {
        auto* choice = find<QComboBox>("tool");
        choice->setCurrentIndex(row);
        Q_EMIT choice->activated(row);
        settle();
    }
    std::shared_ptr<const Tool> last_tool() const {
        const auto* use =
            commands.empty() ? nullptr : std::get_if<command::UseTool>(&commands.back());
        return use ? use->tool : nullptr;
    }
};

TEST_F(PanelTool, asks_for_the_tool_that_is_chosen_in_the_size_that_is_set) {
    set_smooth({});
    commands.clear();
    choose(1);
    ASSERT_TRUE(last_tool());
    const double radius = last_tool()->radius();
    EXPECT_GT(radius, 1);
    EXPECT_EQ(effect.settings().tool, last_tool());
    EXPECT_TRUE(find<QLabel>("tool_about")->text().contains("points"));
    find<NumberBox>("tool_scale_box")->setValue(2);
    settle();
    EXPECT_NEAR(last_tool()->radius(), 2 * radius, 1e-9);
    choose(0);
    ASSERT_FALSE(commands.empty());
    EXPECT_FALSE(std::get<command::UseTool>(commands.back()).tool);
    EXPECT_TRUE(find<QLabel>("tool_about")->text().isEmpty());
}

TEST_F(PanelTool, goes_back_where_the_session_refuses) {
    set_smooth({});
    choose(4);
    const auto burr = last_tool();
    refuse_with = "no";
    choose(1);
    EXPECT_EQ(effect.settings().tool, burr);
    EXPECT_EQ(find<QComboBox>("tool")->currentIndex(), 4);
    refuse_with.clear();
    // On the linear field tools are refused in words.
    set({});
    commands.clear();
    choose(2);
    EXPECT_TRUE(commands.empty());
    EXPECT_EQ(find<QComboBox>("tool")->currentIndex(), 0);
    EXPECT_FALSE(find<QLabel>("tool_part_message")->text().isEmpty());
}

TEST_F(PanelTool, that_a_session_brings_is_shown_and_keeps_its_points) {
    RendererSettings settings;
    const std::vector<Vec3> points{Vec3(0, 0, 0), Vec3(0, 0, 7)};
    const ToolShape shape{{{0, 0, 0}, {1, 0, 0}, {0, 0, 7}}, {{0, 1, 2}}};
    settings.tool = std::make_shared<const Tool>(points, 3, false, shape);
    set_smooth(settings);
    EXPECT_EQ(find<QComboBox>("tool")->currentText(), "As given");
    EXPECT_TRUE(find<QLabel>("tool_about")->text().contains("2 points"));
    commands.clear();
    find<NumberBox>("tool_scale_box")->setValue(0.5);
    settle();
    ASSERT_TRUE(last_tool());
    EXPECT_EQ(last_tool()->points().size(), 2U);
    EXPECT_NEAR(last_tool()->radius(), 3.5, 1e-9);
    EXPECT_FALSE(last_tool()->turns());
    ASSERT_EQ(last_tool()->shape().triangles.size(), 1U);
    EXPECT_EQ(last_tool()->shape().vertices[2], Vec3(0, 0, 3.5));
    // Another session's takes its place in the list.
    const int choices = find<QComboBox>("tool")->count();
    settings.tool = std::make_shared<const Tool>(rod_tool(7, 1));
    set_smooth(settings);
    EXPECT_EQ(find<QComboBox>("tool")->count(), choices);
    EXPECT_TRUE(find<QLabel>("tool_about")->text().contains("8 points"));
}

TEST_F(PanelTool, of_a_file_is_one_more_choice) {
    set_smooth({});
    commands.clear();
    panel.tool_controls().add("hook.csv", io::PointsSpec{{Vec3::Zero(), Vec3(1, 0, 2)}});
    settle();
    ASSERT_TRUE(last_tool());
    EXPECT_EQ(last_tool()->points().size(), 2U);
    EXPECT_EQ(find<QComboBox>("tool")->currentText(), "hook.csv");
}

}  // namespace
}  // namespace palpate::viewer
