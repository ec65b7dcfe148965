// The proxy's guarantees G1-G5 on scanned data: noise, plateaus, values equal to the isovalue, thin
// slices. The head comes with the project; tests of other volumes are skipped where those are
// missing.
#include <gtest/gtest.h>

#include <filesystem>

#include "io/real_volumes.hpp"
#include "palpate/io/volume_file.hpp"
#include "support/cubic_guarantees.hpp"
#include "support/fields.hpp"
#include "support/guarantees.hpp"
#include "support/hand.hpp"
#include "support/layer_order.hpp"

using namespace palpate;
using namespace palpate::support;

namespace {

using io::test::Scan;

class ProxyOnRealVolumes : public testing::TestWithParam<Scan> {};

}  // namespace

TEST_P(ProxyOnRealVolumes, keeps_its_guarantees) {
    const Scan scan = GetParam();
    const auto path = io::test::real_volume(scan.file);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const Field field = linear_field(io::read_volume(path).volume, scan.solid);
    // Little outside, much sliding, and strokes and jumps through everything.
    Hand hand(field.geometry(), 5, {.slide = 8, .sweep = 3, .jump = 1, .margin = -1});
    Guarantees checked(field, &update_exact);
    Proxy proxy;
    proxy.isovalue = scan.isovalue;
    constexpr int updates = scaled(100000);
    for (int i = 0; i < updates && !HasFailure(); ++i) {
        SCOPED_TRACE(std::string(scan.file) + " update " + std::to_string(i));
        checked.update(proxy, hand.next());
    }
    checked.print(scan.file);
    EXPECT_GT(checked.tally().constrained_share(), 0.05);
    EXPECT_GT(checked.tally().long_moves, updates / 200);
    EXPECT_GT(checked.tally().motions, checked.tally().constrained);
    EXPECT_EQ(checked.tally().recovering, 0);
}

TEST_P(ProxyOnRealVolumes, keeps_its_guarantees_on_the_smooth_field) {
    const Scan scan = GetParam();
    const auto path = io::test::real_volume(scan.file);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const Field field(io::read_volume(path).volume, scan.solid, std::nullopt, Interpolation::cubic);
    Hand hand(field.geometry(), 6, {.slide = 8, .sweep = 3, .jump = 1, .margin = -1});
    CubicGuarantees checked(field);
    Proxy proxy;
    proxy.isovalue = scan.isovalue;
    const int count = scaled_or_asked(2000);
    for (int i = 0; i < count && !HasFailure(); ++i) {
        SCOPED_TRACE(std::string(scan.file) + " update " + std::to_string(i));
        checked.update(proxy, hand.next());
    }
    checked.print(scan.file);
    EXPECT_GT(checked.tally().constrained, count / 50);
    EXPECT_EQ(checked.tally().out_of_budget, 0);
}

TEST_P(ProxyOnRealVolumes, keeps_the_order_of_layers) {
    const Scan scan = GetParam();
    const auto path = io::test::real_volume(scan.file);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const Volume volume = io::read_volume(path).volume;
    for (const bool cubic : {false, true}) {
        TestField test{scan.file, linear_field(volume, scan.solid), scan.isovalue};
        if (cubic) test = {test.name + " smooth", smooth(test.field), test.isovalue};
        // The isovalue is among five levels; the innermost holds.
        const Layers layers = planned_layers(test, {.parts = {-0.03, 0, 0.05, 0.1, 0.3},
                                                    .forces = {0.2, 0.4, 0.3, 0.5, HUGE_VAL},
                                                    .stiffnesses = {0.5, 0.5, 0.5, 0.5, 0.5}});
        LayerOrder order(test.field, layers);
        Hand hand(test.field.geometry(), 7, {.slide = 4, .sweep = 5, .jump = 1, .margin = -1});
        const int count = scaled_or_asked(cubic ? 3000 : 20000);
        for (int i = 0; i < count && !HasFailure(); ++i) {
            SCOPED_TRACE(test.name + " tick " + std::to_string(i));
            order.tick(hand.next());
        }
        order.print(test.name);
        EXPECT_GT(order.tally().ahead, count / 500);
        EXPECT_GT(order.tally().punctures, count / 500);
        EXPECT_LE(order.tally().out_of_budget, count / 200) << "jumps across all of it";
    }
}

TEST(LayersOnTheHead, keep_their_order_from_skin_to_bone) {
    const auto path = io::test::real_volume("head");
    for (const bool cubic : {false, true}) {
        TestField test{"skin and bone", linear_field(io::read_volume(path).volume), 0};
        if (cubic) test = {test.name + " smooth", smooth(test.field), 0};
        Layers layers = planned_layers(
            test, {.parts = {0, 0, 0}, .forces = {0.4, 0.3, 1.5}, .stiffnesses = {0.3, 0.5, 1.2}});
        layers.layers[0].level = io::sample_volume_skin;
        layers.layers[1].level = 0.5 * (io::sample_volume_skin + io::sample_volume_bone);
        layers.layers[2].level = io::sample_volume_bone;
        LayerOrder order(test.field, layers);
        Hand hand(test.field.geometry(), 8, {.slide = 5, .sweep = 5, .jump = 1, .margin = 2});
        const int count = scaled_or_asked(cubic ? 10000 : 50000);
        for (int i = 0; i < count && !testing::Test::HasFailure(); ++i) {
            SCOPED_TRACE(test.name + " tick " + std::to_string(i));
            order.tick(hand.next());
        }
        order.print(test.name);
        EXPECT_GT(order.tally().behind, count / 500);
        EXPECT_GT(order.tally().punctures, count / 500);
        EXPECT_GT(order.tally().outward, count / 5000);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Scans, ProxyOnRealVolumes,
    testing::Values(Scan{"head", io::sample_volume_skin}, Scan{"head", io::sample_volume_bone},
                    Scan{"head", io::sample_volume_skin, Solid::below}, Scan{"lobster.nrrd", 35},
                    Scan{"lobster.nrrd", 110}, Scan{"orange.nrrd", 15}, Scan{"orange.nrrd", 60},
                    Scan{"daisy_pollen.nrrd", 40}, Scan{"daisy_pollen.nrrd", 100},
                    Scan{"cthead_unc.nrrd", 500}, Scan{"cthead_unc.nrrd", 1200},
                    Scan{"cthead_unc.nrrd", 500, Solid::below}, Scan{"iguana.nii.gz", 120}));
