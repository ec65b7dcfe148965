// Force settings, the switches and the force gauge.
#include "tests/viewer/panel/panel_fixture.hpp"

#include <set>

#include <QProgressBar>
#include <QPushButton>
#include <QSlider>

#include <functional>
#include <limits>

#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/window/device_controls.hpp"

namespace palpate::viewer {
namespace {

class Forces : public PanelFixture {
  protected:
    /// Not the defaults, so that a setting that is lost on the way shows.
    static RendererSettings unusual() {
        RendererSettings settings;
        settings.force = {.stiffness = 0.8,
                          .damping = 2e-4,
                          .viscosity = 1e-4,
                          .magnet = {3, 0.5},
                          .texture = {0.1, 4},
                          .limit = 2.5,
                          .rate_limit = 1234,
                          .ramp = 0.3,
                          .stale_after = 0.03,
                          .start_below = 0.4,
                          .rotational_stiffness = 20,
                          .rotational_damping = 0.01,
                          .torque_limit = 60,
                          .torque_rate_limit = 3e4};
        settings.proxy.friction = {0.5, 0.25};
        return settings;
    }
};

TEST_F(Forces, each_number_changes_its_setting_and_nothing_else) {
    struct Case {
        const char* box;
        const char* text;
        std::function<void(ForceSettings&)> change;
    };
    const Case cases[] = {
        {"stiffness_box", "1.25", [](ForceSettings& f) { f.stiffness = 1.25; }},
        {"damping_box", "0.0003", [](ForceSettings& f) { f.damping = 0.0003; }},
        {"viscosity_box", "5e-5", [](ForceSettings& f) { f.viscosity = 5e-5; }},
        {"texture_amplitude_box", "0.25", [](ForceSettings& f) { f.texture.amplitude = 0.25; }},
        {"texture_wavelength_box", "7", [](ForceSettings& f) { f.texture.wavelength = 7; }},
        {"magnet_distance_box", "5", [](ForceSettings& f) { f.magnet.distance = 5; }},
        {"magnet_peak_box", "0.9", [](ForceSettings& f) { f.magnet.peak = 0.9; }},
        {"force_limit_box", "1.5", [](ForceSettings& f) { f.limit = 1.5; }},
        {"force_rate_limit_box", "700", [](ForceSettings& f) { f.rate_limit = 700; }},
        {"force_ramp_box", "0.75", [](ForceSettings& f) { f.ramp = 0.75; }},
        {"force_to_start_below_box", "inf",
         [](ForceSettings& f) { f.start_below = std::numeric_limits<double>::infinity(); }},
        {"stale_time_box", "0.015", [](ForceSettings& f) { f.stale_after = 0.015; }},
        {"rotational_stiffness_box", "30", [](ForceSettings& f) { f.rotational_stiffness = 30; }},
        {"rotational_damping_box", "0.02", [](ForceSettings& f) { f.rotational_damping = 0.02; }},
        {"torque_limit_box", "45", [](ForceSettings& f) { f.torque_limit = 45; }},
        {"torque_rate_limit_box", "1e4", [](ForceSettings& f) { f.torque_rate_limit = 1e4; }},
    };
    for (const Case& one : cases) {
        SCOPED_TRACE(one.box);
        set(unusual());
        commands.clear();
        type(one.box, one.text);
        ForceSettings expected = unusual().force;
        one.change(expected);
        const auto asked = of<ForceSettings>();
        ASSERT_EQ(asked.size(), 1U);
        EXPECT_EQ(asked.front(), expected);
        EXPECT_EQ(effect.settings().force, expected);
        EXPECT_EQ(commands.size(), 1U);
    }
}

TEST_F(Forces, the_stiffness_slider_ends_where_it_can_still_be_rendered) {
    set(unusual());
    auto* slider = find<QSlider>("stiffness_slider");
    slider->setFocus();
    QTest::keyClick(slider, Qt::Key_End);
    ASSERT_EQ(of<ForceSettings>().size(), 1U);
    EXPECT_EQ(of<ForceSettings>().back().stiffness,
              greatest_stiffness(unusual().device, 2e-4 + 1e-4));
    EXPECT_EQ(message("force_part"), "");
    // Now there is no room for more damping; its slider has come to its end.
    auto* damping = find<QSlider>("damping_slider");
    EXPECT_EQ(damping->value(), damping->maximum());
}

/// Names of all numbers in the tables of force and friction.
std::vector<std::string> names_of_rows() {
    std::vector<std::string> names;
    RendererSettings settings;
    const auto add = [&](const std::string&, const auto& setting, double) {
        names.push_back(QString(setting.title).replace(' ', '_').toStdString());
    };
    for_each_number("force", settings.force, add);
    for_each_number("friction", settings.proxy.friction, add);
    return names;
}

TEST_F(Forces, each_number_in_the_tables_has_a_row_with_words_of_its_own) {
    set();
    EXPECT_GE(names_of_rows().size(), 18U);
    std::set<QString> labels;
    for (const std::string& name : names_of_rows()) {
        SCOPED_TRACE(name);
        const auto* box = find<NumberBox>((name + "_box").c_str());
        ASSERT_NE(box, nullptr);
        EXPECT_TRUE(labels.insert(box->accessibleName()).second);
        EXPECT_NE(box->parentWidget()->toolTip(), "");
    }
}

TEST_F(Forces, every_slider_end_can_be_rendered) {
    for (const std::string& name : names_of_rows()) {
        SCOPED_TRACE(name);
        for (const auto end : {Qt::Key_End, Qt::Key_Home}) {
            set(unusual());
            commands.clear();
            auto* slider = find<QSlider>((name + "_slider").c_str());
            slider->setFocus();
            QTest::keyClick(slider, end);
            settle();
            EXPECT_EQ(message("force_part"), "");
            EXPECT_LE(commands.size(), 1U);  // none where it was there already
        }
    }
}

TEST_F(Forces, settings_that_cannot_be_rendered_are_refused_with_the_reason) {
    set(unusual());
    type("stiffness_box", "50");
    EXPECT_TRUE(message("force_part").contains("to be rendered stably"));
    EXPECT_EQ(find<NumberBox>("stiffness_box")->value(), 0.8);
    type("damping_box", "1");
    EXPECT_TRUE(message("force_part").contains("damping"));
    type("force_limit_box", "-2");
    EXPECT_TRUE(message("force_part").contains("force limit"));
    type("dynamic_friction_box", "0.9");
    EXPECT_TRUE(message("force_part").contains("friction"));
    type("texture_wavelength_box", "0");
    EXPECT_TRUE(message("force_part").contains("wavelength"));
    EXPECT_TRUE(commands.empty());
    EXPECT_EQ(find<NumberBox>("dynamic_friction_box")->value(), 0.25);
}

TEST_F(Forces, dynamic_friction_goes_down_with_the_static_one) {
    set(unusual());
    type("static_friction_box", "0.75");
    type("static_friction_box", "0.1");
    const auto asked = of<Friction>();
    ASSERT_EQ(asked.size(), 2U);
    EXPECT_EQ(asked[0].static_coefficient, 0.75);
    EXPECT_EQ(asked[0].dynamic_coefficient, 0.25);
    EXPECT_EQ(asked[1].static_coefficient, 0.1);
    EXPECT_EQ(asked[1].dynamic_coefficient, 0.1);
    EXPECT_TRUE(of<ForceSettings>().empty());
}

TEST_F(Forces, the_wheel_over_a_number_without_focus_scrolls_the_panel) {
    set();
    panel.resize(400, 700);
    panel.setFocus();
    for (const char* name : {"stiffness_box", "stiffness_slider", "preset", "solid", "devices"}) {
        auto* widget = find<QWidget>(name);
        const QPointF at = QRectF(widget->rect()).center();
        QWheelEvent event(at, widget->mapToGlobal(at.toPoint()), {}, {0, -120}, Qt::NoButton,
                          Qt::NoModifier, Qt::NoScrollPhase, false);
        QApplication::sendEvent(widget, &event);
        EXPECT_FALSE(event.isAccepted()) << name;
    }
    settle();
    EXPECT_TRUE(commands.empty());
}

TEST_F(Forces, snapshots_move_the_gauge_and_say_what_holds_the_force_back) {
    set(unusual());
    auto* bar = find<QProgressBar>("force_bar");
    const auto reduced = [this] { return find<QLabel>("force_reduced")->text(); };
    Snapshot now;
    now.session.tick.force = Vec3(0, 1.2, 0.5);
    effect.observe(now);
    EXPECT_EQ(find<QLabel>("force_number")->text(), "1.30 N");
    EXPECT_EQ(find<QLabel>("force_most")->text(), "of 2.5 N");
    EXPECT_EQ(bar->value(), 520);
    EXPECT_EQ(bar->maximum(), 1000);
    EXPECT_EQ(reduced(), "");
    const QImage before = bar->grab().toImage();
    now.session.tick.force = Vec3(0, 2.5, 0);
    now.session.tick.force_flags = force_limited;
    effect.observe(now);
    EXPECT_EQ(bar->value(), 1000);
    EXPECT_EQ(reduced(), "limit");
    EXPECT_NE(bar->grab().toImage(), before);
    now.session.tick.force_flags = force_waiting;
    effect.observe(now);
    EXPECT_EQ(reduced(), "waiting");
    now.session.tick.force_flags = force_stale;
    now.forces_on = true;
    effect.observe(now);
    EXPECT_EQ(reduced(), "no input");
    EXPECT_EQ(find<QPushButton>("forces")->text(), "Forces WAIT\nno input from the device");
    now.session.tick.force_flags = force_off;
    effect.observe(now);
    EXPECT_EQ(reduced(), "off");
}

TEST_F(Forces, the_gauge_ends_at_the_devices_limit_where_that_is_less) {
    RendererSettings settings = unusual();
    settings.force.limit = 8;
    set(settings);
    effect.observe({});
    EXPECT_EQ(find<QLabel>("force_most")->text(), "of 3.3 N");
}

TEST_F(Forces, the_pull_is_shown_in_millimetres_of_hand_and_volume) {
    set();
    Snapshot now;
    now.session.tick.proxy.mode = Mode::constrained;
    now.session.tick.proxy.hip = Vec3(0, 3, 0);
    now.session.tick.proxy.scp = Vec3(0, 0, 0);
    now.session.transform.scale = 2;
    effect.observe(now);
    const QString text = find<QLabel>("contact")->text();
    EXPECT_TRUE(text.contains("1.50 mm")) << text.toStdString();
    EXPECT_TRUE(text.contains("3.00 mm")) << text.toStdString();
    EXPECT_TRUE(text.startsWith("In contact"));
}

TEST_F(Forces, switches_request_the_opposite_and_show_the_state_in_snapshots) {
    set();
    auto* forces = find<QPushButton>("forces");
    EXPECT_TRUE(forces->isChecked());
    press("forces");
    ASSERT_EQ(of<command::Forces>().size(), 1U);
    EXPECT_FALSE(of<command::Forces>().back().on);
    EXPECT_EQ(forces->text(), "Forces are OFF");
    Snapshot now;  // taken before the command was obeyed
    effect.observe(now);
    EXPECT_FALSE(forces->isChecked()) << "it must not flicker";
    now.forces_on = false;
    effect.observe(now);
    EXPECT_FALSE(forces->isChecked());
    now.forces_on = true;  // somebody else switched them on
    effect.observe(now);
    EXPECT_TRUE(forces->isChecked());
    press("forces");
    EXPECT_EQ(of<command::Forces>().size(), 2U);
}

TEST_F(Forces, a_switch_without_effect_goes_back) {
    set();
    press("freeze");
    EXPECT_TRUE(of<command::Freeze>().back().on);
    for (int i = 0; i < 10; ++i) effect.observe({});
    EXPECT_FALSE(find<QPushButton>("freeze")->isChecked());
}

TEST_F(Forces, freeze_and_clutch_are_shown_as_the_session_has_them) {
    set();
    Snapshot now;
    now.session.frozen = true;
    now.session.clutched = true;  // by a button of the device
    effect.observe(now);
    EXPECT_TRUE(find<QPushButton>("freeze")->isChecked());
    EXPECT_TRUE(find<QPushButton>("clutch")->isChecked());
    press("clutch");
    EXPECT_FALSE(of<command::Clutch>().back().on);
}

TEST_F(Forces, a_refused_switch_goes_back_and_says_why) {
    set();
    refuse_with = "too many commands at once";
    press("forces");
    EXPECT_TRUE(find<QPushButton>("forces")->isChecked());
    EXPECT_EQ(message("session_part"), "too many commands at once");
}

TEST_F(Forces, a_switch_that_cannot_be_carried_out_at_all_goes_back_and_says_why) {
    set();
    effect.begin(*field, 300, {}, desktop_device(), histogram,
                 [](const Command&) { throw std::logic_error("the run has stopped"); });
    press("forces");
    EXPECT_TRUE(find<QPushButton>("forces")->isChecked());
    EXPECT_EQ(message("session_part"), "the run has stopped");
}

TEST_F(Forces, what_somebody_else_asks_for_is_shown_and_refused_where_it_belongs) {
    set(unusual());
    ForceSettings force = unusual().force;
    force.stiffness = 1;
    EXPECT_TRUE(effect.request(force));
    EXPECT_EQ(find<NumberBox>("stiffness_box")->value(), 1);
    force.stiffness = -1;
    EXPECT_FALSE(effect.request(force));
    EXPECT_EQ(find<NumberBox>("stiffness_box")->value(), 1);
    EXPECT_EQ(effect.settings().force.stiffness, 1);
    EXPECT_FALSE(message("force_part").isEmpty());
    EXPECT_TRUE(effect.request(command::Isovalue{77}));
    EXPECT_EQ(find<NumberBox>("isovalue_box")->value(), 77);
}

TEST_F(Forces, return_presses_a_button_that_has_the_focus) {
    set();
    auto* freeze = find<QPushButton>("freeze");
    freeze->setFocus();
    QTest::keyClick(freeze, Qt::Key_Return);
    ASSERT_EQ(of<command::Freeze>().size(), 1U);
    EXPECT_TRUE(of<command::Freeze>().back().on);
}

TEST_F(Forces, tab_goes_through_the_panel_from_top_to_bottom) {
    RendererSettings settings = unusual();
    settings.penetrability = penetrability_threshold(1, 0);
    set(settings);
    std::set<QWidget*> visited;
    for (const char* page : {"penetrability_part", "look_part", "edit_part", "device_part"}) {
        find<Section>(page);
        QApplication::processEvents();
        int before = -1;
        for (QWidget* one = panel.nextInFocusChain(); one != &panel;
             one = one->nextInFocusChain()) {
            if (!panel.isAncestorOf(one) || !one->isVisible() || !one->isEnabled()) continue;
            if (!(one->focusPolicy() & Qt::TabFocus) || one->focusProxy()) continue;
            const int top = one->mapTo(&panel, QPoint(0, 0)).y();
            EXPECT_GE(top, before - one->fontMetrics().height()) << one->objectName().toStdString();
            before = top;
            visited.insert(one);
        }
    }
    EXPECT_GT(visited.size(), 80U);
}

}  // namespace
}  // namespace palpate::viewer
