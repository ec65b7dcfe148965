// A baseline for tools: points that are inside push out in proportion to their depth, as the point
// shell of McNeely, Puterbaugh and Troy 1999, with a proxy in quasi-static equilibrium between them
// and the hand (Wan and McNeely 2003). Through the public API only.
#pragma once

#include <memory>

#include "palpate/field.hpp"
#include "palpate/tool.hpp"

namespace palpate::baselines {

struct PenaltySettings {
    /// Stiffness of a point beside that of the coupling to the hand.
    double point_stiffness = 4;
    double deepest = 1;  ///< [voxel] deeper points push no harder, as in a shell of voxels
    int steps = 1;       ///< towards the equilibrium, an update
};

/// The state between updates.
struct PenaltyTool {
    std::shared_ptr<const Tool> tool;  ///< not null
    double isovalue = 0;               ///< [data units]
    Pose pose = {};                    ///< of the proxy
    bool placed = false;               ///< false: the next update starts at the hand's pose
};

struct PenaltyUpdate {
    Pose proxy;
    int inside = 0;      ///< points inside, before the last step
    double deepest = 0;  ///< [mm] of them, by the field's slope
};

/// One tick: the coupling's energy k / 2 (|translation|^2 + |gyration * rotation|^2) and half of
/// each point's stiffness times its squared depth, brought towards its least by a step of Gauss and
/// Newton. Never throws or allocates. Nothing holds a point that has gone to where the field falls
/// again.
PenaltyUpdate update_penalty(PenaltyTool& state, const Field& field, const Pose& hand,
                             const PenaltySettings& settings = {}) noexcept;

}  // namespace palpate::baselines
