// Meshes of fewer triangles, for files.
#pragma once

#include <cstddef>
#include <functional>

#include "palpate/surface.hpp"

namespace palpate::viewer {

/// The mesh with about `most_triangles`, or more where its shape does not allow so few. A closed
/// mesh stays closed, and its vertices stay where they are: some are left out. Without normals.
/// Throws what `progress` throws. (Schroeder, Zarge and Lorensen 1992)
SurfaceMesh decimated(const SurfaceMesh& mesh, std::size_t most_triangles,
                      const std::function<void(double)>& progress);

}  // namespace palpate::viewer
