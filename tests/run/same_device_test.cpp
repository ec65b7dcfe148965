// A run whose device is chosen again while it is in use, on a stand-in for a vendor's library.
#include <algorithm>

#include "devices/forcedimension/forcedimension.hpp"
#include "devices/forcedimension/mock_dhd.hpp"
#include "devices/vendor_device.hpp"
#include "run/run_support.hpp"

namespace palpate::run {
namespace {

/// Its thread makes a step where the servo reads or waits.
class Stepped final : public Device {
  public:
    explicit Stepped(std::unique_ptr<devices::forcedimension::DhdDevice> device)
        : device_(std::move(device)) {}

    DeviceInfo info() const override { return device_->info(); }
    std::string problem() const override { return device_->problem(); }
    DeviceReading read(double time) override {
        support::pass(std::chrono::milliseconds(1));
        device_->step();
        return device_->read(time);
    }
    void write(const Wrench& wrench, double time) override { device_->write(wrench, time); }
    void stop() noexcept override { device_->stop(); }
    bool is_stopping() const noexcept override {
        device_->step();
        return device_->is_stopping();
    }

  private:
    std::unique_ptr<devices::forcedimension::DhdDevice> device_;
};

devices::DeviceChoice omega(const std::string& options = "") {
    return devices::parse_device("forcedimension:library=" + std::string(MOCK_DRD) + options);
}

/// Opens all devices as usual but this one.
Setup with_stepped(const devices::DeviceChoice& device) {
    Setup setup;
    setup.real_time = false;
    setup.device = device;
    setup.open_device = [](const auto& choice, const auto& scene) -> std::unique_ptr<Device> {
        if (choice.name != "forcedimension") return devices::open_device(choice, scene);
        return std::make_unique<Stepped>(devices::forcedimension::open(
            choice, scene, {&support::virtual_now, &support::pass_until}));
    };
    return setup;
}

/// Long enough for a device to be looked after, and for its force to pass.
constexpr int soon = 50;

class SameDevice : public testing::Test {
  protected:
    template <class F>
    auto with(F act) const {
        const std::lock_guard lock(mock_->mutex);
        return act(mock_->state);
    }
    SameDevice() {
        with([](auto& dhd) { dhd.type = 35; });  // has a gripper
        live_.emplace(data_, with_stepped(omega()));
        live_->start();
        test::step(*live_, soon);
        EXPECT_TRUE(is_ready());
    }

    bool is_ready() const {
        return live_->snapshot()->session.device.status == DeviceStatus::ready;
    }
    /// Moves the hand along x of the library, until its device presses with more than half a
    /// newton.
    bool presses() {
        for (double x = 0.06; x > -0.06; x -= 0.0002) {
            with([&](auto& dhd) { dhd.position = {x, 0, 0}; });
            test::step(*live_, 1);
            if (with([](auto& dhd) { return std::abs(dhd.force[0]) > 0.5; })) return true;
        }
        return false;
    }
    /// Open, switched on, watched and with its gripper as a button, by one who does not call a
    /// closed one.
    void expect_all_set_up() {
        test::step(*live_, soon);
        EXPECT_TRUE(is_ready());
        EXPECT_EQ(live_->device_problem(), "");
        with([](auto& dhd) {
            EXPECT_TRUE(dhd.is_open && dhd.force_on && dhd.emulates_button);
            EXPECT_EQ(dhd.watchdog, 240);
            EXPECT_EQ(dhd.wrong_id, 0);
        });
        EXPECT_TRUE(presses());
    }

    support::MockDhd* mock_ = devices::plugged_in<support::MockDhdState>(MOCK_DRD, "mock_dhd");
    std::shared_ptr<Data> data_ = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    std::optional<run::Run> live_;
};

TEST_F(SameDevice, is_closed_without_force_before_it_is_opened_with_other_options) {
    for (const char* options : {"", ",spring=1", ",spring=1"}) {
        ASSERT_TRUE(presses());
        with([](auto& dhd) {
            dhd.calls.clear();
            dhd.force_at_stop = {1, 1, 1};
        });
        live_->use_device(omega(options));
        EXPECT_EQ(live_->setup().device, omega(options));
        with([](auto& dhd) {
            const std::vector<std::string> expected{"watchdog", "stop", "drd close", "drd open"};
            EXPECT_EQ(dhd.calls, expected);
            EXPECT_EQ(dhd.force_at_stop, (std::array<double, 3>{}));
        });
        expect_all_set_up();
    }
}

TEST_F(SameDevice, whose_options_are_refused_goes_on_as_it_was) {
    with([](auto& dhd) { dhd.active_gripper = false; });
    const auto refused = [&] { live_->use_device(omega(",spring=1")); };
    EXPECT_NE(support::message_of<devices::DeviceError>(refused).find("spring="),
              std::string::npos);
    EXPECT_EQ(live_->setup().device, omega());
    expect_all_set_up();
}

TEST_F(SameDevice, that_cannot_be_opened_again_is_lost_until_it_is_chosen_once_more) {
    ASSERT_TRUE(presses());
    with([](auto& dhd) { dhd.count = 0; });
    EXPECT_THROW(live_->use_device(omega()), devices::DeviceError);
    test::step(*live_, soon);
    EXPECT_EQ(live_->snapshot()->session.device.status, DeviceStatus::lost);
    EXPECT_EQ(live_->snapshot()->session.tick.force, Vec3(0, 0, 0));
    EXPECT_NE(live_->device_problem().find("no device (0 found)"), std::string::npos);
    with([](auto& dhd) {
        EXPECT_FALSE(dhd.is_open);
        dhd.count = 1;
    });
    live_->use_device(omega());
    expect_all_set_up();
}

TEST_F(SameDevice, is_not_closed_for_another_hand_that_chooses_it) {
    run::Run other(data_, with_stepped(devices::parse_device("mouse")));
    other.start();
    with([](auto& dhd) { dhd.calls.clear(); });
    EXPECT_THROW(other.use_device(omega()), devices::DeviceError);
    EXPECT_NE(other.mouse(), nullptr);
    EXPECT_TRUE(with([](auto& dhd) { return dhd.calls.empty(); }));
    EXPECT_TRUE(presses());
    live_->use_device(devices::parse_device("mouse"));  // the first hand has let go of it
    EXPECT_NO_THROW(other.use_device(omega()));
}

}  // namespace
}  // namespace palpate::run
