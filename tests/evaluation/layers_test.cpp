// layers in its quick mode, its phantoms and closed forms.
#include <algorithm>
#include <limits>

#include "evaluation/claims.hpp"
#include "evaluation/layers/heads.hpp"
#include "evaluation/layers/insertion.hpp"

namespace palpate::evaluation {
namespace {

TEST(LayersExperiment, claims_hold_in_quick_mode) {
    const Result result = quick_result(layers);
    EXPECT_EQ(result.claims.size(), 7U);
    EXPECT_EQ(result.figures.size(), 4U);
    // Two bodies, two fields, four speeds.
    EXPECT_EQ(result.summary.rows().size(), 16U);
    EXPECT_EQ(result.table.where("part", "cost").rows().size(), 10U);
}

TEST(LayersExperiment, meets_bone_after_the_skin_and_again_from_behind) {
    Table table;
    for (const LayeredHead& head : layered_heads(quick_options())) add_head(table, head, true);
    const Table events = table.where("part", "head event").where("surfaces", head_sets[1]);
    std::vector<std::string> order;
    for (std::size_t i = 0; i < events.rows().size(); ++i) order.push_back(events.text(i, "order"));
    EXPECT_EQ(order, (std::vector<std::string>{"on skin", "through skin", "on bone", "through bone",
                                               "on bone from behind", "through bone from behind"}));
}

TEST(LayersExperiment, says_which_real_heads_are_not_there) {
    Options options;
    std::string notes;
    options.note = [&](const std::string& note) { notes += note + "\n"; };
    EXPECT_EQ(layered_heads(options).size(), 1U);
    EXPECT_NE(notes.find("without the CT head"), std::string::npos) << notes;
    EXPECT_NE(notes.find("without the Visible Human head"), std::string::npos) << notes;
}

TEST(LayersExperiment, a_volume_of_the_user_takes_the_place_of_heads) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("sphere:24x24x24"));
    const auto bodies = layered_heads(options);
    ASSERT_EQ(bodies.size(), 1U);
    EXPECT_EQ(bodies[0].name, "sphere");
    Table table;
    add_head(table, bodies[0], true);
    for (const Claim& claim : head_claims(table)) EXPECT_TRUE(claim.held) << claim.measured;
    options.subjects = {synthetic("sphere:16x16x16", 1000.0)};
    EXPECT_THROW((void)layers(options), std::invalid_argument);
}

TEST(LayersExperiment, stops_where_progress_throws) {
    struct Stop {};
    Options options = quick_options();
    options.progress = [](double) { throw Stop(); };
    EXPECT_THROW((void)layers(options), Stop);
}

TEST(LayeredPhantoms, have_their_depth_as_density) {
    scenes::Random random(3);
    for (const LayeredPhantom& phantom : {ramp_phantom(), ball_phantom()}) {
        for (int i = 0; i < 50; ++i) {
            const HandLine line = phantom.line(random);
            EXPECT_NEAR(line.inward.norm(), 1, 1e-12);
            for (double depth = 5; depth < phantom_depth; depth += 0.37) {
                EXPECT_NEAR(value_at(phantom.field, line.at(depth)), depth, 1e-3) << phantom.name;
            }
        }
    }
}

/// A hand that goes in by tiny steps: the surface that holds it, and where it last gave way.
double stepped_spring(const Layers& layers, double depth) {
    constexpr double step = 1e-4;
    std::size_t next = 0;
    double force = 0;
    for (double at = 0; at <= depth; at += step) {
        force = 0;
        while (next < layers.layers.size() && at > layers.layers[next].level) {
            const Layer& layer = layers.layers[next];
            force = stiffness_of(layer) * (at - layer.level);
            if (force < puncture_force_of(layer)) break;
            force = 0;
            ++next;
        }
    }
    return force;
}

TEST(ClosedForm, is_that_of_a_hand_that_goes_in_by_tiny_steps) {
    const Layers layers = five_tissues();
    for (const double depth :
         {9.0, 10.5, 12.9, 13.1, 16.1, 19.4, 19.6, 31.0, 32.3, 33.6, 35.6, 35.7, 59.0, 62.0}) {
        EXPECT_NEAR(spring_at(layers, depth), stepped_spring(layers, depth), 5e-4) << depth;
    }
}

TEST(ClosedForm, of_drag_is_drag_times_length_in_what_gave_way) {
    const Layers layers = needle_tissues();
    EXPECT_EQ(drag_at(layers, 12.9), 0) << "the skin still holds";
    EXPECT_NEAR(drag_at(layers, 13.1), 0.03 * 3.1, 1e-12);
    EXPECT_NEAR(drag_at(layers, 61), 0.03 * 6 + 0.01 * 14 + 0.05 * 3.5 + 0.03 * 26.5, 1e-12)
        << "the bone at 60 holds the tip";
}

}  // namespace
}  // namespace palpate::evaluation
