// Makes the mesh of one block of cells, with normals.
#pragma once

#include <limits>

#include "apps/viewer/scene/render_mesh.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// Where a surface is kept [index of a sample].
struct SurfaceBounds {
    Vec3 low = Vec3::Constant(-std::numeric_limits<double>::infinity());
    Vec3 high = Vec3::Constant(std::numeric_limits<double>::infinity());
};

/// The isosurface in the `edge`^3 cells from `cell` on; positions from `middle` [mm, physical].
/// Normals as pictures::shaded_surface has them. Looks at samples from one before the cells to one
/// behind their last. Null where nothing of the surface lies.
/// What would lie beyond the bounds lies on them: the surface of a coarse field would be closed a
/// coarse sample outside of the data.
std::shared_ptr<const RenderMesh> block_mesh(const Field& field, double isovalue,
                                             const Index3& cell, int edge, const Vec3& middle,
                                             const SurfaceBounds& bounds = {});

}  // namespace palpate::viewer
