// drift in its quick mode.
#include "evaluation/claims.hpp"

namespace palpate::evaluation {
namespace {

TEST(Drift, claims_hold_in_quick_mode) {
    const Result result = quick_result(drift);
    EXPECT_EQ(result.claims.size(), 4U);
}

TEST(Drift, a_volume_of_the_user_takes_the_place_of_its_own) {
    Options options = quick_options();
    options.subjects.push_back(synthetic("torus:40x40x20"));
    const Result result = drift(options);
    EXPECT_EQ(result.claims.size(), 3U);
    EXPECT_EQ(result.table.text(0, "volume"), "torus");
    EXPECT_TRUE(all_hold(result));
}

}  // namespace
}  // namespace palpate::evaluation
