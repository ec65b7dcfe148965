// How proxy updates are timed on a machine that others use too: the same trajectories in several
// passes. A proxy does the same work in every pass, so what differs between passes is the
// machine's.
#pragma once

#include <cstdint>
#include <vector>

#include "evaluation/exploring_hand.hpp"

namespace palpate::evaluation {

struct TimingPlan {
    int passes = 5;
    int cold_updates = 0;  ///< so many are timed after the caches were emptied
};

/// Times in ns; NaN where nothing was timed.
struct UpdateTimes {
    /// Timed in batches, without a clock inside: of each batch the median of its passes.
    double mean_ns = 0;
    /// Over updates timed one by one, reading the clock included: each the median of its passes.
    double p50_ns = 0, p99_ns = 0, p999_ns = 0, max_ns = 0;
    double interrupted_max_ns = 0;  ///< the largest single time of any pass
    double clock_ns = 0;            ///< what an empty interval shows: the median
    double cold_p50_ns = 0;
    // The same on every machine:
    std::int64_t updates = 0;
    std::int64_t tetrahedra = 0;   ///< through which the SCP moved, all updates together
    std::int64_t constrained = 0;  ///< updates that ended constrained
    std::int64_t unfinished = 0;   ///< updates that ended neither done nor refused
};

UpdateTimes time_updates(const Subject& subject, ProxyMethod method,
                         const std::vector<Trajectory>& trajectories, const TimingPlan& plan);

}  // namespace palpate::evaluation
