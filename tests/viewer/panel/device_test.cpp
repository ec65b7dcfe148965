// The device controls and the servo loop's figures.
#include <QComboBox>
#include <QLineEdit>
#include <QPushButton>
#include <QToolButton>

#include "apps/viewer/panel/device_controls.hpp"
#include "apps/viewer/panel/hand_switch.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "tests/viewer/panel/panel_fixture.hpp"

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

TEST_F(Devices, each_purpose_takes_one_of_the_devices_buttons_or_none) {
    set();
    std::vector<run::Buttons> wanted;
    QObject::connect(&panel.device_controls(), &DeviceControls::buttons_wanted,
                     [&](const run::Buttons& buttons) { wanted.push_back(buttons); });
    auto *clutch = find<QComboBox>("clutch_button"), *deadman = find<QComboBox>("deadman_button");
    panel.device_controls().set_buttons({});
    EXPECT_FALSE(clutch->isEnabled());
    EXPECT_EQ(deadman->toolTip(), "The device has no buttons");
    DeviceInfo info = desktop_device();
    info.buttons = 3;
    effect.begin(*field, 300, {}, info, histogram, [](const Command&) {});
    panel.device_controls().set_buttons({});
    EXPECT_EQ(clutch->currentText(), "the second, or the only one");
    EXPECT_EQ(deadman->currentText(), "none");
    EXPECT_EQ(deadman->count(), 4);
    find<QComboBox>("deadman_button")->setFocus();
    QTest::keyClick(deadman, Qt::Key_Down);
    ASSERT_EQ(wanted.size(), 1U);
    EXPECT_EQ(wanted[0], (run::Buttons{run::UsualButton{}, run::Button{1}}));
    EXPECT_EQ(deadman->currentText(), "none") << "nobody has carried it out";
    panel.device_controls().set_buttons(wanted[0]);
    EXPECT_EQ(deadman->currentText(), "button 1");
    clutch->setFocus();
    QTest::keyClick(clutch, Qt::Key_End);
    ASSERT_EQ(wanted.size(), 2U);
    EXPECT_EQ(wanted[1], (run::Buttons{run::Button{3}, run::Button{1}}));
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
