// A baseline for tools: points inside the solid push out in proportion to their depth, like the
// point shell of McNeely, Puterbaugh and Troy 1999. The proxy is in quasi-static equilibrium
// between them and the hand (Wan and McNeely 2003). Uses the public API only.
#pragma once

#include <memory>

#include "palpate/field.hpp"
#include "palpate/tool.hpp"

namespace palpate::baselines {

struct PenaltySettings {
    /// Stiffness of a point, relative to that of the coupling to the hand.
    double point_stiffness = 4;
    double deepest =
        1;          ///< [voxel] deeper points push with the same force, as in a shell of voxels
    int steps = 1;  ///< towards the equilibrium, per update
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

/// One tick: a Gauss-Newton step towards the minimum of the coupling's energy k / 2
/// (|translation|^2 + |gyration * rotation|^2) plus half of each point's stiffness times its
/// squared depth. Never throws or allocates. A point that is so deep that the field falls again is
/// no longer pushed out.
PenaltyUpdate update_penalty(PenaltyTool& state, const Field& field, const Pose& hand,
                             const PenaltySettings& settings = {}) noexcept;

}  // namespace palpate::baselines
