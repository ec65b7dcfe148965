// The explicit approach beside ours: the whole isosurface is extracted and put into a hierarchy
// before anything can be touched, and again when the level changes. By palpate-explicit-helper.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluation/explicit_helper/wire.hpp"
#include "evaluation/subject.hpp"

namespace palpate::evaluation {

/// From free space to the hand [mm, physical].
struct Segment {
    Vec3 from, to;
};

struct ExplicitAnswer {
    ExplicitCost cost;
    std::vector<double> hits;  ///< how far along each segment, 0 to 1; NaN: none
    std::string failure;       ///< empty: it worked; else nothing else is set
};

/// Extraction and hierarchy `repeats` times, and the segments' first hits. `progress` is called
/// while the helper works, and may throw to stop it.
ExplicitAnswer explicit_surface(const Subject& subject, const std::vector<Segment>& segments,
                                int repeats, const std::function<void(double)>& progress);

}  // namespace palpate::evaluation
