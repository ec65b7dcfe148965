// The tetrahedra of the lattice at the SCP, the isosurface in them and the constraint planes, as in
// the paper's figures.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "apps/viewer/scene/render_mesh.hpp"
#include "palpate/lattice.hpp"

namespace palpate::viewer {

/// A constraint plane: the proxy has to stay on the side to which the normal points.
struct ConstraintPlane {
    Vec3 point = Vec3::Zero();   ///< the SCP [mm, physical]
    Vec3 normal = Vec3::Zero();  ///< unit, out of the solid, physical axes
};

struct LocalTetrahedron {
    std::array<Vec3, 4> corners;  ///< cell centre, face centre, the edge's two ends [mm, physical]
    /// The isosurface in it, as convex polygons of 3 or 4 corners, in turn [mm, physical]: one at
    /// most on a linear field, several along the curved surface of a cubic one.
    std::vector<std::vector<Vec3>> patch;
    /// Where the point lies on the isosurface and the field is not constant here.
    std::optional<ConstraintPlane> plane;
};

std::vector<LocalTetrahedron> local_tetrahedra(const Field& field, const LatticePoint& point,
                                               double isovalue);

/// The isosurface within some voxels of the point, from the middle of the grid; null where there
/// is none. A few milliseconds.
std::shared_ptr<const RenderMesh> local_patch(const Field& field, const Vec3& physical,
                                              double isovalue);

}  // namespace palpate::viewer
