// Splits the facets of a mesh until they are as near to the smooth isosurface as asked for.
#pragma once

#include "palpate/surface.hpp"

namespace palpate::marching {

/// Edges whose middle is farther than `tolerance` [mm] from the isosurface get a vertex there, on
/// it, again and again up to eight times. Which edges are split depends on their ends alone, so a
/// closed mesh stays closed and neighbouring boxes still fit. `options` gives the bound on
/// vertices, beyond which std::length_error is thrown, and `progress`; false if that cancelled.
bool refine(SurfaceMesh& mesh, const Field& field, double isovalue, double tolerance,
            const SurfaceOptions& options);

}  // namespace palpate::marching
