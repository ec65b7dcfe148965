// The purposes of a device's buttons, chosen in the panel while the volume is felt.
#include <QAction>
#include <QComboBox>
#include <QStatusBar>

#include <atomic>
#include <limits>
#include <memory>
#include <utility>

#include "apps/viewer/model/session_file.hpp"
#include "palpate/devices/devices.hpp"
#include "palpate/io/recording.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

/// Another device, with two buttons.
class WithButtons final : public Device {
  public:
    WithButtons(std::unique_ptr<Device> device, const std::atomic<std::uint32_t>& held)
        : device_(std::move(device)), held_(held) {}

    DeviceInfo info() const override {
        DeviceInfo info = device_->info();
        info.buttons = 2;
        return info;
    }
    DeviceReading read(double time) override {
        DeviceReading reading = device_->read(time);
        reading.buttons = held_;
        return reading;
    }
    void write(const Wrench& wrench, double time) override { device_->write(wrench, time); }
    void stop() noexcept override { device_->stop(); }

  private:
    std::unique_ptr<Device> device_;
    const std::atomic<std::uint32_t>& held_;
};

class DeviceButtons : public InWindow {
  protected:
    /// A hand in the solid that feels force at once, with buttons.
    void feel_with_buttons() {
        run::Setup setup = setup_with("simulated:hand=hold,depth=4,seconds=3600");
        setup.render.force.start_below = std::numeric_limits<double>::infinity();
        setup.open_device = [this](const auto& choice,
                                   const auto& scene) -> std::unique_ptr<Device> {
            return std::make_unique<WithButtons>(devices::open_device(choice, scene), held_);
        };
        open_window(setup);
        feel("synthetic:sphere:48x48x48");
    }
    void choose(const char* purpose, Qt::Key key) {
        auto& box = part<QComboBox>(purpose);
        box.setFocus();
        QTest::keyClick(&box, key);
    }

    std::atomic<std::uint32_t> held_{0};
};

TEST_F(DeviceButtons, a_dead_man_button_is_chosen_and_gives_force_only_while_it_is_held) {
    feel_with_buttons();
    wait_until([&] { return force() > 0.05; });
    const double isovalue = window_->live()->isovalue();
    choose("deadman_button", Qt::Key_Down);
    const run::Buttons chosen{run::UsualButton{}, run::Button{1}};
    EXPECT_EQ(window_->live()->setup().buttons, chosen);
    EXPECT_EQ(part<QComboBox>("deadman_button").currentText(), "button 1");
    EXPECT_EQ(window_->live()->isovalue(), isovalue);
    wait_until([&] { return window_->live()->snapshot().has_value(); });
    wait_for_ticks(50);
    EXPECT_EQ(force(), 0);
    held_ = 1;
    wait_until([&] { return force() > 0.05; });
    held_ = 0;
    wait_until([&] { return force() == 0; });
    // One button has one purpose.
    choose("clutch_button", Qt::Key_End);
    EXPECT_EQ(window_->live()->setup().buttons.clutch, run::ButtonSetup(run::Button{2}));
    choose("clutch_button", Qt::Key_Up);
    EXPECT_TRUE(window_->messages().problem().contains("the same button"));
    EXPECT_EQ(part<QComboBox>("clutch_button").currentText(), "button 2");
    EXPECT_EQ(window_->live()->setup().buttons.clutch, run::ButtonSetup(run::Button{2}));
    window_->messages().forget();
    // Those of the next volume and of a session are these.
    window_->files().save_session(scratch("day.json"));
    feel("synthetic:torus:32x32x16");
    const run::Buttons both{run::Button{2}, run::Button{1}};
    EXPECT_EQ(window_->live()->setup().buttons, both);
    EXPECT_EQ(read_session(scratch("day.json").toStdString()).buttons, both);
}

TEST_F(DeviceButtons, that_change_end_a_recording_as_another_field_does_and_the_window_says_so) {
    feel_with_buttons();
    for (const char* change : {"deadman_button", "solid"}) {
        SCOPED_TRACE(change);
        const QString name = scratch((std::string(change) + ".csv").c_str());
        type_in_dialog(Qt::Key_R, name);
        wait_until([&] { return window_->recordings().recording(); });
        wait_until([&] { return window_->live()->recording()->ticks() > 50; });
        choose(change, Qt::Key_Down);
        EXPECT_FALSE(window_->recordings().recording());
        EXPECT_EQ(window_->statusBar()->currentMessage(),
                  "Recorded up to this change: the session began anew");
        EXPECT_FALSE(window_->findChild<QAction*>("record")->isChecked());
        io::RecordingReader written(name.toStdString());
        while (written.next()) {
        }
        EXPECT_TRUE(written.complete());
    }
}

}  // namespace
}  // namespace palpate::viewer::test
