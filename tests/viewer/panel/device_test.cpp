// The device controls and the servo loop's figures.
#include <QComboBox>
#include <QLineEdit>
#include <QPushButton>
#include <QToolButton>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/window/device_controls.hpp"
#include "tests/viewer/panel/panel_fixture.hpp"

namespace palpate::viewer {
namespace {

const std::vector<devices::DeviceFinding> findings{
    {"simulated", true, "a device and its hand, computed", "", "seed=1"},
    {"mouse", true, "pointer and keys", "", "speed=600 [mm/s]"},
    {"haply", false, "", "no Inverse Service at localhost:10001", "host=localhost,port=10001"}};

class Devices : public PanelFixture {
  protected:
    QComboBox* picker() { return find<QComboBox>("devices"); }
    DeviceControls& controls() { return panel.device_controls(); }
    /// Presses a button that opens a device, until that is done or refused.
    void connect_by(const char* name) {
        press(name);
        wait_until_connected();
    }
    void wait_until_connected() {
        wait_until([this] { return !controls().connector().task().busy(); });
    }
    std::string used() { return run::text_of(content.live()->setup().device); }
};

TEST_F(Devices, the_device_in_use_is_shown_with_its_options) {
    feel("simulated:depth=3,seed=7");
    controls().list(findings);
    EXPECT_TRUE(picker()->currentText().startsWith("simulated"));
    EXPECT_EQ(find<QLineEdit>("device_options")->text(), "depth=3,seed=7");
}

TEST_F(Devices, connecting_goes_on_with_the_device_of_this_name_and_these_options) {
    feel("simulated");
    controls().list(findings);
    picker()->setFocus();
    QTest::keyClick(picker(), Qt::Key_Down);
    connect_by("connect_device");
    EXPECT_EQ(used(), "mouse");
    auto* options = find<QLineEdit>("device_options");
    EXPECT_EQ(options->placeholderText(), "speed=600 [mm/s]");
    options->setFocus();
    QTest::keyClicks(options, "speed=300");
    QTest::keyClick(options, Qt::Key_Return);
    wait_until_connected();
    EXPECT_EQ(used(), "mouse:speed=300");
}

TEST_F(Devices, a_device_that_was_not_found_says_why_and_can_be_tried_elsewhere) {
    feel("simulated:seed=7");
    controls().list(findings);
    const int haply = picker()->findText("haply", Qt::MatchStartsWith);
    ASSERT_GE(haply, 0);
    EXPECT_EQ(picker()->itemData(haply, Qt::ToolTipRole).toString(),
              "no Inverse Service at localhost:10001");
    EXPECT_EQ(picker()->itemData(haply, Qt::ForegroundRole).value<QBrush>().color(),
              picker()->palette().color(QPalette::Disabled, QPalette::Text));
    picker()->setFocus();
    QTest::keyClick(picker(), Qt::Key_End);
    EXPECT_EQ(find<QLabel>("device_missing")->text(), "no Inverse Service at localhost:10001");
    QTest::keyClicks(find<QLineEdit>("device_options"), "host=127.0.0.1,port=1");
    connect_by("connect_device");
    EXPECT_TRUE(messages.problem().contains("127.0.0.1:1")) << messages.problem().toStdString();
    EXPECT_EQ(used(), "simulated:seed=7") << "it cannot be had: the one before goes on";
    EXPECT_TRUE(picker()->currentText().startsWith("simulated"));
    EXPECT_EQ(find<QLineEdit>("device_options")->text(), "seed=7");
}

TEST_F(Devices, simulated_and_mouse_are_always_there) {
    feel("mouse");
    controls().list({});
    EXPECT_GE(picker()->findText("simulated", Qt::MatchStartsWith), 0);
    EXPECT_GE(picker()->findText("mouse", Qt::MatchStartsWith), 0);
    controls().list(findings);
    EXPECT_EQ(picker()->count(), 3);
    EXPECT_TRUE(picker()->currentText().startsWith("mouse"));
}

TEST_F(Devices, invalid_options_are_refused_in_the_panel) {
    feel("mouse");
    controls().list(findings);
    QTest::keyClicks(find<QLineEdit>("device_options"), "speed=1,speed=2");
    connect_by("connect_device");
    EXPECT_EQ(used(), "mouse");
    EXPECT_TRUE(message("device_part").contains("speed"));
}

TEST_F(Devices, one_is_added_as_a_second_hand_and_removed_again) {
    feel("mouse");
    controls().list({});
    EXPECT_FALSE(find<QPushButton>("remove_hand")->isVisible());
    QTest::keyClicks(find<QLineEdit>("device_options"), "speed=300");
    connect_by("add_hand");
    ASSERT_EQ(content.hands(), 2);
    EXPECT_EQ(content.hand(), 2);
    EXPECT_EQ(used(), "mouse:speed=300");
    EXPECT_FALSE(find<QPushButton>("add_hand")->isVisible());
    press("remove_hand");
    EXPECT_EQ(content.hands(), 1);
    EXPECT_EQ(used(), "mouse");
    EXPECT_TRUE(find<QPushButton>("add_hand")->isVisible());
}

TEST_F(Devices, the_device_state_is_shown_with_what_to_do) {
    set();
    DeviceInfo info = desktop_device();
    info.name = "haply";
    info.model = "Inverse3 0A1B";
    info.workspace_low = Vec3(-70, 0, -50);
    info.workspace_high = Vec3(70, 100, 50);
    info.limits.maximum_force = 4;
    controls().show_device(info, DeviceStatus::uncalibrated, "move the arm to its corner");
    EXPECT_EQ(find<QLabel>("device_state")->text(), "needs calibration");
    EXPECT_EQ(find<QLabel>("device_problem")->text(), "move the arm to its corner");
    EXPECT_TRUE(find<QLabel>("device_problem")->isVisible());
    EXPECT_EQ(find<QLabel>("device_model")->text(), "haply, Inverse3 0A1B");
    EXPECT_EQ(find<QLabel>("device_workspace")->text(), "140 x 100 x 100 mm, up to 4 N");
    const QColor amber = find<QLabel>("device_dot")->palette().color(QPalette::WindowText);
    controls().show_device(info, DeviceStatus::ready, {});
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

TEST_F(Devices, without_buttons_gives_them_no_purpose_and_says_so) {
    feel("mouse");
    for (const char* purpose : {"clutch_button", "deadman_button"}) {
        EXPECT_FALSE(find<QComboBox>(purpose)->isEnabled());
        EXPECT_EQ(find<QComboBox>(purpose)->toolTip(), "The device has no buttons");
    }
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
    EXPECT_EQ(find<QLabel>("loop_missed")->text(), "3 of 5003 ticks, 1 forces cancelled");
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

}  // namespace
}  // namespace palpate::viewer
