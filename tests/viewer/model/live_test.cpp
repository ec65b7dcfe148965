// A session as the window holds it.
#include "apps/viewer/model/live.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace palpate::viewer {
namespace {

using namespace std::chrono_literals;

app::TouchOptions on_a_ball(const std::string& device) {
    app::TouchOptions options;
    options.volume.volume = "synthetic:sphere:32x32x32";
    options.device = device;
    return options;
}

TEST(Live, commands_show_in_settings_and_snapshots) {
    const app::TouchOptions options = on_a_ball("mouse");
    Live live(app::load(options.volume, {}), options);
    ASSERT_NE(live.mouse(), nullptr);
    ForceSettings force = live.settings().force;
    force.stiffness = 0.25;
    live.send(force);
    EXPECT_EQ(live.settings().force.stiffness, 0.25);
    for (int i = 0; i < 2000; ++i) {
        const auto now = live.snapshot();
        if (now && now->stiffness == 0.25) return;
        std::this_thread::sleep_for(1ms);
    }
    FAIL() << "the servo never used the stiffness";
}

}  // namespace
}  // namespace palpate::viewer
