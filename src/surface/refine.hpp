// Splits the facets of a mesh until they are as near to the smooth isosurface as asked for.
#pragma once

#include "palpate/surface.hpp"

namespace palpate::marching {

/// Edges whose middle is farther than `tolerance` [mm] from the isosurface get a vertex there, on
/// it, again and again up to eight times. Which edges are split depends on their ends alone, so a
/// closed mesh stays closed and neighbouring boxes still fit. Throws std::length_error beyond
/// `max_vertices`.
void refine(SurfaceMesh& mesh, const Field& field, double isovalue, double tolerance,
            std::uint64_t max_vertices);

}  // namespace palpate::marching
