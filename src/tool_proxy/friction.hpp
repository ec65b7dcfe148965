// Coulomb friction at the contacts of a tool.
#pragma once

#include "palpate/proxy.hpp"
#include "tool_proxy/nearest.hpp"

namespace palpate::tool {

/// The directions in which a contact would slip, as motions of the tool: two tangents.
struct Tangents {
    std::array<Six, 2> row;
};

/// What is left of a pull when friction at the contacts holds what it can: at each contact a
/// tangential part of at most `coefficient` times its pressure. `half_spaces` and `tangents` are
/// those of the contacts, lengths are correct to `tolerance`. `slips` says whether a contact would
/// still move along its surface, by more than `at_rest`.
struct Held {
    Six pull;
    bool slips;
    int work = 0;  ///< in units of ToolSettings::work_budget
};
Held held_by_friction(const Six& pull, const HalfSpace6* half_spaces, const Tangents* tangents,
                      int count, double coefficient, double tolerance, double at_rest);

}  // namespace palpate::tool
