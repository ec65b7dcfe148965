// The next move of method exact: h, the vector from the SCP to its target, projected on the free
// cones of the tetrahedra that contain the SCP (docs/proxy.md).
#pragma once

#include "proxy/site.hpp"

namespace palpate {

/// A move that brings the SCP closer to its target, in one of its incident tetrahedra.
struct Move {
    Tetrahedron tetrahedron;
    Vec3 step = Vec3::Zero();  ///< folded [voxel]
    unsigned walls = 0;        ///< the SCP stays on these
    double gain = 0;           ///< |step|^2 [mm^2]: by how much the squared distance can fall
    bool straight = false;     ///< the step is h itself
    int work = 0;              ///< of general projections, see ProxySettings
};

/// The best move of an SCP that is in contact or on at least one wall.
Move best_constrained_move(const Site& site, unsigned on, bool contact, const Vec3& h);

/// The best move of an SCP that is on the walls `on`; in contact it must not rise above the
/// isosurface. h is folded, in voxels. (Inside a tetrahedron a straight move has no gain set.)
inline Move best_move(const Site& site, unsigned on, bool contact, const Vec3& h) {
    if (on != 0 || contact) return best_constrained_move(site, on, contact, h);
    return {.tetrahedron = site.point.tetrahedron, .step = h, .straight = true};
}

/// The same for an SCP on at least one wall, by the general projection in every incident
/// tetrahedron: what best_move() falls back to, and the reference that tests compare it with.
Move best_of_all(const Site& site, unsigned on, bool contact, const Vec3& h);

}  // namespace palpate
