// What a run is set up with: the rate that suits the device.
#include <gtest/gtest.h>

#include "palpate/run/run.hpp"
#include "support/eventually.hpp"

namespace palpate::run {
namespace {

TEST(Setup, a_device_without_force_needs_a_quarter_of_the_ticks_and_shows_the_same_force) {
    DeviceInfo with, without;
    without.renders_force = false;
    run::Setup setup;
    EXPECT_EQ(rate_of(setup.render, with), 1000);
    EXPECT_EQ(rate_of(setup.render, without), 250);
    const auto data = std::make_shared<Data>(load(source_named("synthetic:sphere:32x32x32")));
    const Field field = make_field(data->loaded().volume, {});
    const auto stiffness = [&](const DeviceInfo& info) {
        return make_session(field, 100, info, setup).renderer.settings.force.stiffness;
    };
    EXPECT_EQ(stiffness(with), stiffness(without));

    setup.device = devices::parse_device("mouse");
    setup.real_time = false;
    run::Run live(data, setup);
    live.start();
    ASSERT_TRUE(support::comes_true([&] {
        const auto now = live.snapshot();
        return now && now->number >= 50;
    }));
    // In session time, which does not depend on the machine.
    const Snapshot now = *live.snapshot();
    EXPECT_GE(now.session.tick.time, 0.99 * double(now.number) / 250);

    setup.render.rate = 2000;
    EXPECT_EQ(rate_of(setup.render, without), 2000);
}

}  // namespace
}  // namespace palpate::run
