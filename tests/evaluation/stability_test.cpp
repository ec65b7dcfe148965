// stability, in its quick mode.
#include "evaluation/claims.hpp"

namespace palpate::evaluation {
namespace {

TEST(Stability, quick_mode_bears_out_its_claims) {
    const Result result = quick_result(stability);
    EXPECT_EQ(result.claims.size(), 2U);
    EXPECT_EQ(result.figures.size(), 2U);
}

TEST(Stability, the_hand_is_in_contact_in_every_case_that_rests) {
    const Table table = stability(quick_options()).table;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "at_rest") == "no") continue;
        EXPECT_EQ(table.text(i, "in_contact"), "yes") << i;
        EXPECT_GT(table.number(i, "push_N"), 0.05) << i;
    }
}

}  // namespace
}  // namespace palpate::evaluation
