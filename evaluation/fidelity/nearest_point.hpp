// The point of a whole isosurface that is nearest to the hand: slow, and what a proxy that walks
// can at best rest on.
#pragma once

#include "palpate/surface.hpp"

namespace palpate::evaluation {

/// The nearest point of a mesh, by looking at all of it [mm]. Throws std::invalid_argument for an
/// empty mesh.
Vec3 nearest_point(const SurfaceMesh& mesh, const Vec3& from);

/// The nearest point of one triangle, its edges and corners included.
Vec3 nearest_in_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from);

}  // namespace palpate::evaluation
