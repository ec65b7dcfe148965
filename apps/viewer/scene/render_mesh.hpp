// Meshes as arrays for graphics hardware, and meshes of fewer triangles: for drawing while things
// move, and for files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "palpate/surface.hpp"

namespace palpate::viewer {

/// Arrays of a triangle mesh: 3 floats a vertex, 3 indices a triangle.
struct RenderMesh {
    std::vector<float> positions;  ///< [mm, physical axes] from an origin, so that floats do
    std::vector<float> normals;    ///< unit, out of the solid
    std::vector<std::int32_t> triangles;
    /// Of a block of a larger mesh: on which of its sides a vertex lies, 0 inside. Vertices that
    /// lie alike go together when it is simplified, so that blocks fit as they did. Or empty.
    std::vector<std::uint8_t> seams;

    std::size_t vertex_count() const { return positions.size() / 3; }
    std::size_t triangle_count() const { return triangles.size() / 3; }
};

/// The mesh with at most about `most_triangles` (some more for very few): vertices in one box of a
/// grid that face the same way become one. The mesh itself if it is small enough. Its outline stays
/// where it is to within the box's size.
RenderMesh simplified(const RenderMesh& mesh, std::size_t most_triangles);

/// Vertices in one box of a grid of `size` [mm] become one if they face the same way.
RenderMesh clustered(const RenderMesh& mesh, float size);
/// [mm^2]
double area_of(const RenderMesh& mesh);

/// Blocks of a mesh; null: there is nothing of it.
using MeshBlocks = std::vector<std::shared_ptr<const RenderMesh>>;
std::size_t triangle_count(std::span<const std::shared_ptr<const RenderMesh>> blocks);
/// All in one, without seams; the only one itself. Null if there is no triangle.
std::shared_ptr<const RenderMesh> joined(std::span<const std::shared_ptr<const RenderMesh>> blocks);

/// The mesh with about `most_triangles`, or more where its shape does not allow so few. A closed
/// mesh stays closed, and its vertices stay where they are: some are left out. Without normals.
/// Throws what `progress` throws. (Schroeder, Zarge and Lorensen 1992)
SurfaceMesh decimated(const SurfaceMesh& mesh, std::size_t most_triangles,
                      const std::function<void(double)>& progress);

}  // namespace palpate::viewer
