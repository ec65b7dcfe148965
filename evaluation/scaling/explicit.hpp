// The explicit approach beside ours: the whole isosurface is extracted and put into a hierarchy
// before anything can be touched, and again when the level changes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluation/exploring_hand.hpp"
#include "evaluation/scaling/explicit_helper/wire.hpp"

namespace palpate::evaluation {

/// What the same touch costs our method. Times in ns.
struct DynamicCost {
    double update_ns = 0;   ///< mean of an update of the hand's trajectories
    double segment_ns = 0;  ///< mean of cast_ray over the segments that the mesh is asked for
    /// The update after the level has changed by a tenth of the data's range, to and fro, recovery
    /// included.
    double change_p50_ns = 0, change_p99_ns = 0, change_max_ns = 0;
    // The same on every machine:
    std::int64_t changes = 0;
    std::int64_t unfinished_changes = 0;  ///< not done after one update
    double worst_deviation = 0;           ///< of those done, from the new level, of the range
    double state_bytes = 0;               ///< of the proxy
    double heap_growth_bytes = 0;         ///< over all updates and changes
};

/// From free space to the hand [mm, physical].
struct Segment {
    Vec3 from, to;
};

/// At most `most` of those from half a voxel above the SCP to the HIP, spread over the
/// trajectories.
std::vector<Segment> segments_of(const Subject& subject,
                                 const std::vector<Trajectory>& trajectories, std::size_t most);

DynamicCost dynamic_cost(const Subject& subject, const std::vector<Trajectory>& trajectories,
                         const std::vector<Segment>& segments, int passes);

struct ExplicitAnswer {
    ExplicitCost cost;
    std::vector<double> hits;  ///< how far along each segment, 0 to 1; NaN: none
    std::string failure;       ///< empty: it worked; else nothing else is set
};

/// By palpate-explicit-helper. `progress` as in Options.
ExplicitAnswer explicit_cost(const Subject& subject, const std::vector<Segment>& segments,
                             int repeats, const std::function<void()>& progress);

/// How the mesh and our surface differ where the segments meet them.
struct Difference {
    double one_sided_share = 0;  ///< of the segments: those that meet only one of the two
    double worst_voxel = 0;      ///< [smallest spacing] between the places, where both are met
};
Difference difference_of(const Subject& subject, const std::vector<Segment>& segments,
                         const std::vector<double>& hits);

}  // namespace palpate::evaluation
