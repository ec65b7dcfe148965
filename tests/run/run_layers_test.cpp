// Layers in a live run: the isovalue that waits for their end.
#include <gtest/gtest.h>

#include "run/run_support.hpp"
#include "support/scratch_folder.hpp"

namespace palpate::run {
namespace {

/// Two levels of the ball at which its session does not begin.
std::shared_ptr<const Layers> two_levels() {
    Layers layers;
    layers.layers.resize(2);
    layers.layers[0].name = "outer";
    layers.layers[0].level = 20;
    layers.layers[1].name = "inner";
    layers.layers[1].level = 30;
    return std::make_shared<const Layers>(layers);
}

class RunWithLayers : public testing::Test {
  protected:
    RunWithLayers()
        : live(test::stepped_data(test::loaded("synthetic:sphere:32x32x32")),
               test::with_device("mouse")) {
        live.start();
        live.send(command::Isovalue{60});
        live.send(command::UseLayers{two_levels()});
        (void)felt(20);
    }
    /// The level of the session in a tick to come.
    bool felt(double level) {
        return test::steps_until(live, [&] {
            const auto now = live.snapshot();
            return now && now->session.tick.proxy.isovalue == level;
        });
    }

    support::ScratchFolder scratch;
    run::Run live;
};

TEST_F(RunWithLayers, the_isovalue_before_is_felt_again_when_they_are_taken_away) {
    EXPECT_EQ(live.isovalue(), 60);
    live.send(command::UseLayers{nullptr});
    EXPECT_EQ(live.isovalue(), 60);
    EXPECT_TRUE(felt(60));
}

TEST_F(RunWithLayers, an_isovalue_that_is_sent_meanwhile_counts_afterwards) {
    live.send(command::Isovalue{70});
    live.send(command::UseLayers{nullptr});
    EXPECT_TRUE(felt(70));
}

TEST_F(RunWithLayers, recordings_that_begin_and_end_meanwhile_do_not_change_it) {
    live.record(scratch.path() / "a.csv");
    EXPECT_EQ(live.isovalue(), 60);
    EXPECT_TRUE(felt(20));
    live.stop_recording();
    EXPECT_EQ(live.isovalue(), 60);
    EXPECT_TRUE(felt(20));
    live.send(command::UseLayers{nullptr});
    live.record(scratch.path() / "b.csv");
    EXPECT_TRUE(felt(60));
}

TEST_F(RunWithLayers, the_other_solid_side_ends_them_and_keeps_the_isovalue) {
    live.use_field(Solid::below, Interpolation::cubic);
    EXPECT_FALSE(live.settings().layers);
    EXPECT_EQ(live.isovalue(), 60);
    EXPECT_TRUE(felt(60));
}

}  // namespace
}  // namespace palpate::run
