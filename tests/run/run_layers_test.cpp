// Layers in a live run: the isovalue that waits for their end.
#include <gtest/gtest.h>

#include "palpate/run/labels.hpp"
#include "palpate/stream/convert.hpp"
#include "run/run_support.hpp"
#include "support/edits.hpp"
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

/// Labels 1 and 3 in turn along x, so that each mean of two is 2.
Volume turns(const Geometry& geometry) {
    std::vector<std::uint8_t> samples(static_cast<std::size_t>(sample_count(geometry)));
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = i % 2 == 0 ? 1 : 3;
    return {geometry, std::move(samples)};
}

TEST(LabelsOfAStore, are_read_whole_because_the_mean_of_two_labels_is_none) {
    const support::ScratchFolder folder;
    const Volume labels = turns(support::grid({160, 128, 128}));
    ASSERT_GT(sample_count(labels.geometry()), stream::overview_samples);
    const std::string path = (folder / "labels.zarr").string();
    stream::convert_to_zarr(*stream::store_of(labels, "labels"), 0, path, {});
    EXPECT_TRUE(support::same_bits(load_labels(path, 0).volume, labels));
    EXPECT_EQ(layers_by_label(load_labels(path, 0)).layers.layers.size(), 2U);
    EXPECT_THROW((void)layers_by_label(load(source_from({{"volume", path}}))),
                 std::invalid_argument);
}

TEST_F(RunWithLayers, the_other_solid_side_ends_them_and_keeps_the_isovalue) {
    live.use_field(Solid::below, Interpolation::cubic);
    EXPECT_FALSE(live.settings().layers);
    EXPECT_EQ(live.isovalue(), 60);
    EXPECT_TRUE(felt(60));
}

}  // namespace
}  // namespace palpate::run
