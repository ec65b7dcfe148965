// Runs an experiment in its quick mode and checks its claims.
#pragma once

#include <gtest/gtest.h>

#include "evaluation/experiment.hpp"

namespace palpate::evaluation {

inline Options quick_options() {
    Options options;
    options.quick = true;
    return options;
}

/// Says which claim does not hold.
inline testing::AssertionResult all_hold(const Result& result) {
    for (const Claim& claim : result.claims) {
        if (!claim.held)
            return testing::AssertionFailure() << claim.statement << ": " << claim.measured;
    }
    return testing::AssertionSuccess();
}

/// The result of the quick mode, complete and with every claim borne out.
inline Result quick_result(Result (*experiment)(const Options&)) {
    Result result = experiment(quick_options());
    EXPECT_TRUE(all_hold(result));
    EXPECT_FALSE(result.claims.empty());
    EXPECT_FALSE(result.table.rows().empty());
    EXPECT_FALSE(result.figures.empty());
    EXPECT_FALSE(result.paragraph.empty());
    return result;
}

}  // namespace palpate::evaluation
