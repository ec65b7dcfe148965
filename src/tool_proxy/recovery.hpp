// Brings a tool out of the solid after the field, the isovalue or the start put points of it there.
#pragma once

#include "tool_proxy/around.hpp"

namespace palpate::tool {

/// True when no point is inside. What the budget does not allow goes on in the next update.
bool recover(ToolProxy& proxy, Around& around, PoseObserver observer);
/// How far from its pose [mm] a search that goes on has looked.
double searched_so_far(const ToolProxy& proxy, const Around& around);

}  // namespace palpate::tool
