// The purposes of a device's buttons, chosen in the panel while the volume is felt.
#include <QComboBox>

#include <atomic>
#include <limits>
#include <memory>
#include <utility>

#include "apps/viewer/model/session_file.hpp"
#include "palpate/devices/devices.hpp"
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
    void choose(const char* purpose, Qt::Key key) {
        auto& box = part<QComboBox>(purpose);
        box.setFocus();
        QTest::keyClick(&box, key);
    }

    std::atomic<std::uint32_t> held_{0};
};

TEST_F(DeviceButtons, a_dead_man_button_is_chosen_and_gives_force_only_while_it_is_held) {
    run::Setup setup = setup_with("simulated:hand=hold,depth=4,seconds=3600");
    // A hand that is in the solid already feels force at once.
    setup.render.force.start_below = std::numeric_limits<double>::infinity();
    setup.open_device = [this](const auto& choice, const auto& scene) -> std::unique_ptr<Device> {
        return std::make_unique<WithButtons>(devices::open_device(choice, scene), held_);
    };
    open_window(setup);
    feel("synthetic:sphere:48x48x48");
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

}  // namespace
}  // namespace palpate::viewer::test
