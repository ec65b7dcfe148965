// Judges the way of a tool from the outside, by values of the field alone.
#pragma once

#include "palpate/tool_proxy.hpp"

namespace palpate::evaluation {

struct ToolVerdict {
    double worst_excess = -1;  ///< [range] on any chord of any point
    double worst_growth = 0;   ///< of the distance to the hand in a tick, in parts of a voxel
    std::int64_t chords = 0;
    std::int64_t unfinished = 0;  ///< updates that ended neither done nor refused
    std::int64_t rounds = 0, work = 0;
    int most_rounds = 0, most_work = 0;
    bool recovering = false;  ///< in the last update
};

/// Makes an update and looks at every pose on its way. Of a tool with many points a part of the
/// chords is judged, another one at each pose. Free before, as a tool that started outside is.
ToolUpdate judged_update(ToolProxy& proxy, const Field& field, const Pose& hand,
                         ToolVerdict& verdict);
/// [range] The greatest excess on a chord: of nine places, refined round the greatest.
double greatest_on_chord(const Field& field, double isovalue, const Vec3& from, const Vec3& to);

}  // namespace palpate::evaluation
