// A run that starts in place of another one, or beside it.
#include <algorithm>
#include <memory>
#include <string>

#include "palpate/run/run.hpp"
#include "run/run_support.hpp"
#include "run/session_settings.hpp"

namespace palpate::run {
namespace {

/// Another device with two buttons, whose motors are warm after a moment.
class SoonWarm final : public Device {
  public:
    explicit SoonWarm(std::unique_ptr<Device> device) : device_(std::move(device)) {}

    DeviceInfo info() const override {
        DeviceInfo info = device_->info();
        info.buttons = 2;
        info.limits.continuous_force = 0.05;
        return info;
    }
    DeviceReading read(double time) override { return device_->read(time); }
    void write(const Wrench& wrench, double time) override { device_->write(wrench, time); }
    void stop() noexcept override { device_->stop(); }

  private:
    const std::unique_ptr<Device> device_;
};

Setup soon_warm(const std::string& depth) {
    Setup setup = test::with_device("simulated:hand=hold,seconds=60,depth=" + depth);
    setup.open_device = [](const auto& choice, const auto& scene) {
        return std::make_unique<SoonWarm>(devices::open_device(choice, scene));
    };
    return setup;
}

/// The greatest force [N] in the next ten seconds.
double most_force(Run& live) {
    double most = 0;
    for (int i = 0; i < 10'000; ++i) {
        live.step();
        most = std::max(most, live.snapshot()->session.tick.force.norm());
    }
    return most;
}

TEST(StartAs, keeps_motors_warm_that_have_other_options_now) {
    const auto data = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    run::Run before(data, soon_warm("5"));
    before.start();
    EXPECT_GT(most_force(before), 0.4) << "they were cold";
    EXPECT_LT(before.snapshot()->session.tick.force.norm(), 0.1);
    run::Run next(data, soon_warm("6"));
    next.start_as(before);
    EXPECT_LT(most_force(next), 0.2);
    next.use_device(devices::parse_device("simulated:hand=hold,seconds=60,depth=7"));
    EXPECT_LT(most_force(next), 0.2);
}

TEST(StartAs, takes_over_buttons_that_were_chosen_after_it_was_made) {
    const auto data = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    run::Run before(data, soon_warm("5"));
    before.start();
    run::Run next(data, soon_warm("6"));
    run::Run without(data, test::with_device("simulated:hand=hold,depth=6,seconds=60"));
    const Buttons chosen{UsualButton{}, Button{1}};
    before.use_buttons(chosen);
    EXPECT_THROW(without.start_as(before), std::invalid_argument) << "has no such button";
    before.step();
    next.start_as(before);
    EXPECT_EQ(next.setup().buttons, chosen);
    EXPECT_EQ(most_force(next), 0) << "nobody holds the dead-man switch";
}

TEST(StartAs, goes_on_with_what_was_asked_for_there_and_ends_the_run_before) {
    const auto data = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    run::Run before(data, test::with_device("mouse"));
    before.start();
    ForceSettings force = before.settings().force;
    force.stiffness = 0.2;
    before.send(force);
    before.send(command::Isovalue{65.5});
    before.use_field(Solid::above, Interpolation::linear);
    before.send(command::Freeze{true});
    run::Run same(data, before.setup());
    EXPECT_THROW(before.start_as(same), WrongState) << "it has started";
    EXPECT_THROW(run::Run(data, before.setup()).start_as(same), WrongState) << "nothing to end";
    same.start_as(before);
    EXPECT_THROW(before.step(), WrongState);
    EXPECT_TRUE(same.frozen()) << "the device is the same";

    run::Run other(data, test::with_device("simulated:hand=hold,depth=5,seconds=60"));
    other.start_as(same);
    EXPECT_FALSE(other.frozen());
    EXPECT_EQ(other.isovalue(), 65.5);
    EXPECT_EQ(other.settings().force.stiffness, 0.2);
    EXPECT_EQ(other.field().interpolation(), Interpolation::linear);
    EXPECT_TRUE(test::steps_until(other, [&] {
        const auto now = other.snapshot();
        return now && now->session.tick.proxy.mode == Mode::constrained;
    }));
}

TEST(Buttons, that_are_left_to_the_program_are_the_default_of_their_purpose) {
    run::Setup setup = test::with_device("simulated");
    DeviceInfo info;
    setup.buttons = {UsualButton{}, UsualButton{}};
    for (const auto& [buttons, clutch] : {std::pair{0, 0U}, {1, 1U}, {2, 2U}, {5, 2U}}) {
        info.buttons = buttons;
        const SessionSettings settings = session_settings(setup, info);
        EXPECT_EQ(settings.clutch_buttons, clutch);
        EXPECT_EQ(settings.deadman_buttons, 0U) << "as without a word about it";
    }
}

TEST(StartBeside, begins_on_the_field_and_with_the_buttons_in_use_by_then) {
    const auto data = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    run::Run first(data, soon_warm("5"));
    first.start();
    run::Run next(data, soon_warm("5"));
    run::Run without(data, test::with_device("simulated:hand=hold,depth=5,seconds=60"));
    const Buttons none{{}, {}}, chosen{UsualButton{}, Button{1}};
    first.use_buttons(chosen);
    EXPECT_THROW(without.start_beside(first), std::invalid_argument) << "has no such button";
    EXPECT_FALSE(without.started());
    first.use_buttons(none);
    first.use_field(Solid::below, Interpolation::linear);
    next.start_beside(first);
    EXPECT_THROW(next.start_beside(first), WrongState);
    EXPECT_EQ(next.setup().buttons, none);
    EXPECT_EQ(next.field().solid(), Solid::below);
    EXPECT_EQ(next.field().interpolation(), Interpolation::linear);
    EXPECT_EQ(next.field().background(), first.field().background());
    next.step();
    EXPECT_EQ(next.snapshot()->number, 0) << "its only session";
}

}  // namespace
}  // namespace palpate::run
