// stability in its quick mode.
#include "evaluation/claims.hpp"

namespace palpate::evaluation {
namespace {

TEST(Stability, claims_hold_in_quick_mode_and_devices_at_rest_are_in_contact) {
    const Result result = quick_result(stability);
    EXPECT_EQ(result.claims.size(), 8U);
    EXPECT_EQ(result.figures.size(), 3U);
    const Table& table = result.table;
    for (std::size_t i = 0; i < table.rows().size(); ++i) {
        if (table.text(i, "at_rest") == "no") continue;
        if (table.text(i, "part").starts_with("rotation")) {
            EXPECT_GT(table.number(i, "torque_N_mm"), 5) << i;
            continue;
        }
        EXPECT_EQ(table.text(i, "in_contact"), "yes") << i;
        EXPECT_GT(table.number(i, "push_N"), 0.05) << i;
    }
}

}  // namespace
}  // namespace palpate::evaluation
