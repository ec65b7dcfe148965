// The setup of a run: the rate that suits the device, and the level.
#include <gtest/gtest.h>

#include "run/run_support.hpp"

namespace palpate::run {
namespace {

TEST(Setup, a_device_without_force_needs_a_quarter_of_the_ticks_and_shows_the_same_force) {
    DeviceInfo with, without;
    without.renders_force = false;
    run::Setup setup;
    EXPECT_EQ(rate_of(setup.render, with), 1000);
    EXPECT_EQ(rate_of(setup.render, without), 250);
    const auto data = test::stepped_data(test::loaded("synthetic:sphere:32x32x32"));
    const Field field = make_field(data->loaded().volume, {});
    const auto stiffness = [&](const DeviceInfo& info) {
        return make_session(field, 100, info, setup).renderer.settings.force.stiffness;
    };
    EXPECT_EQ(stiffness(with), stiffness(without));

    setup.device = devices::parse_device("mouse");
    setup.real_time = false;
    run::Run live(data, setup);
    live.start();
    test::step(live, 51);
    EXPECT_EQ(live.snapshot()->number, 50);
    EXPECT_NEAR(live.snapshot()->session.tick.time, 50.0 / 250, 1e-12);

    setup.render.rate = 2000;
    EXPECT_EQ(rate_of(setup.render, without), 2000);
}

TEST(Setup, springs_have_to_be_stable_at_the_slower_of_device_and_loop) {
    const Field field = make_field(test::loaded("synthetic:sphere:32x32x32").volume, {});
    const auto settings = [&](double rate, double stiffness,
                              const std::optional<DeviceLimits>& limits) {
        RenderSetup setup;
        setup.rate = rate;
        setup.stiffness = stiffness;
        return render_settings(setup, field, 100, limits);
    };
    EXPECT_EQ(settings(4000, 15, std::nullopt).device.rate, 4000);
    EXPECT_THROW(settings(4000, 15, DeviceLimits{.rate = 500}), std::invalid_argument);
    EXPECT_EQ(settings(4000, 2, DeviceLimits{.rate = 500}).device.rate, 500);
    EXPECT_THROW(settings(500, 15, DeviceLimits{.rate = 4000}), std::invalid_argument);
    EXPECT_EQ(settings(500, 2, DeviceLimits{.rate = 4000}).device.rate, 500);

    DeviceInfo slow;
    slow.limits.rate = 50;
    run::Setup setup;
    EXPECT_EQ(make_session(field, 100, slow, setup).renderer.settings.force.stiffness, 0.25);
    setup.render.stiffness = 0.5;  // is refused, as it was asked for
    EXPECT_THROW(make_session(field, 100, slow, setup), std::invalid_argument);
}

TEST(Setup, who_stops_the_search_for_an_isovalue_is_obeyed) {
    struct Stopped {};
    const LoadedVolume loaded = test::loaded("synthetic:sphere:128x128x128");
    LoadedVolume other = loaded;
    other.isovalue = std::nullopt;
    run::Setup setup;
    EXPECT_NO_THROW((void)isovalue_of(other, setup));
    EXPECT_THROW((void)isovalue_of(other, setup, [](double) { throw Stopped{}; }), Stopped);
    EXPECT_NO_THROW((void)isovalue_of(loaded, setup, [](double) { throw Stopped{}; }));
}

}  // namespace
}  // namespace palpate::run
