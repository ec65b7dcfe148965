// The panel with a live run: what it asks for is carried out, and both agree.
#include "palpate/run/run.hpp"

#include <QPushButton>
#include <QSlider>

#include "apps/viewer/model/transfer.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/level_chart.hpp"
#include "tests/viewer/panel/panel_fixture.hpp"

namespace palpate::viewer {
namespace {

class WithLive : public PanelFixture {
  protected:
    WithLive() {
        run::Setup setup;
        setup.device = {"mouse", {}};
        const auto source = run::source_named("synthetic:sphere:32x32x32");
        live = std::make_unique<run::Run>(std::make_shared<run::Data>(run::load(source)), setup);
        live->start();
        histogram = run::histogram_of(live->field().volume(), 256);
        effect.begin(live->field(), live->isovalue(), live->settings(), live->device(), histogram,
                     [this](const Command& command) {
                         commands.push_back(command);
                         try {
                             live->send(command);
                         } catch (const std::invalid_argument& error) {
                             refusals.push_back(error.what());
                             throw;
                         }
                     });
        QApplication::processEvents();
    }

    void expect_agreement() {
        const RendererSettings& a = effect.settings();
        const RendererSettings& b = live->settings();
        EXPECT_EQ(effect.isovalue(), live->isovalue());
        EXPECT_EQ(a.force.stiffness, b.force.stiffness);
        EXPECT_EQ(a.force.damping, b.force.damping);
        EXPECT_EQ(a.force.limit, b.force.limit);
        EXPECT_EQ(a.force.start_below, b.force.start_below);
        EXPECT_EQ(a.force.texture.amplitude, b.force.texture.amplitude);
        EXPECT_EQ(a.proxy.friction.static_coefficient, b.proxy.friction.static_coefficient);
        EXPECT_EQ(a.proxy.friction.dynamic_coefficient, b.proxy.friction.dynamic_coefficient);
        EXPECT_EQ(a.penetrability.on, b.penetrability.on);
        EXPECT_EQ(a.penetrability.threshold, b.penetrability.threshold);
        ASSERT_EQ(a.penetrability.range_count, b.penetrability.range_count);
        for (int i = 0; i < a.penetrability.range_count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            EXPECT_EQ(a.penetrability.ranges[at].low, b.penetrability.ranges[at].low);
            EXPECT_EQ(a.penetrability.ranges[at].high, b.penetrability.ranges[at].high);
        }
    }

    std::unique_ptr<run::Run> live;
    std::vector<std::string> refusals;
};

TEST_F(WithLive, random_requests_by_mouse_and_keys_are_all_carried_out) {
    std::mt19937 random(17);
    const std::vector<const char*> sliders{
        "stiffness_slider",       "damping_slider",          "viscosity_slider",
        "static_friction_slider", "dynamic_friction_slider", "texture_amplitude_slider",
        "magnet_distance_slider", "magnet_peak_slider",      "force_limit_slider",
        "threshold_slider",       "isovalue_slider"};
    const std::vector<const char*> buttons{"penetrability", "add_range", "forces", "freeze",
                                           "clutch"};
    auto* chart = find<LevelChart>("level_chart");
    const auto on_chart = [&](double y) {
        return QPointF(std::uniform_int_distribution(0, chart->width())(random), y);
    };
    for (int i = 0; i < 400; ++i) {
        if (random() % 3 == 0) {
            auto* button = find<QAbstractButton>(buttons[random() % buttons.size()]);
            if (button->isVisible()) QTest::mouseClick(button, Qt::LeftButton);
        } else if (random() % 2) {
            const double y = random() % 2 ? 40 : chart->strip().center().y();
            drag(chart, on_chart(y), on_chart(y),
                 random() % 4 ? Qt::NoModifier : Qt::ShiftModifier);
        } else {
            auto* slider = find<QSlider>(sliders[random() % sliders.size()]);
            slider->setFocus();
            const Qt::Key keys[] = {Qt::Key_PageUp, Qt::Key_PageDown, Qt::Key_Home, Qt::Key_End};
            if (slider->isEnabled()) QTest::keyClick(slider, keys[random() % 4]);
        }
        if (const auto now = live->snapshot()) effect.observe(*now);
    }
    settle();
    EXPECT_TRUE(refusals.empty()) << refusals.front();
    EXPECT_GT(commands.size(), 100U);
    expect_agreement();
}

TEST_F(WithLive, switches_show_in_the_sessions_own_snapshots) {
    press("forces");
    type("stiffness_box", "0.25");
    type("scale", "3");
    std::optional<Snapshot> now;
    wait_until([&] {
        now = live->snapshot();
        return now && !now->forces_on && now->stiffness == 0.25 &&
               now->session.transform.scale == 3;
    });
    effect.observe(*now);
    EXPECT_FALSE(find<QPushButton>("forces")->isChecked());
    EXPECT_EQ(find<QLabel>("device_state")->text(), "ready");
}

}  // namespace
}  // namespace palpate::viewer
