// Makes the mesh of one block of cells, with normals.
#pragma once

#include "apps/viewer/scene/render_mesh.hpp"
#include "palpate/field.hpp"

namespace palpate::viewer {

/// The isosurface in the `edge`^3 cells from `cell` on; positions from `middle` [mm, physical].
/// Normals as pictures::shaded_surface has them. Looks at samples from one before the cells to one
/// behind their last. Null where nothing of the surface lies.
std::shared_ptr<const RenderMesh> block_mesh(const Field& field, double isovalue,
                                             const Index3& cell, int edge, const Vec3& middle);

}  // namespace palpate::viewer
