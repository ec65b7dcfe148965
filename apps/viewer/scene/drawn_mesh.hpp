// Meshes in the form that graphics hardware takes, and simpler ones to draw while things move.
#pragma once

#include <cstdint>
#include <vector>

#include "pictures/scene.hpp"

namespace palpate::viewer {

/// Arrays of a triangle mesh: 3 floats a vertex, 3 indices a triangle.
struct DrawnMesh {
    std::vector<float> positions;  ///< [mm, physical axes] from an origin, so that floats do
    std::vector<float> normals;    ///< unit, out of the solid
    std::vector<std::int32_t> triangles;

    std::size_t vertex_count() const { return positions.size() / 3; }
    std::size_t triangle_count() const { return triangles.size() / 3; }
};

/// A surface with a normal a vertex, its positions measured from `origin` [mm, physical].
DrawnMesh drawn_mesh(const pictures::Surface& surface, const Vec3& origin);

/// The mesh with at most about `most_triangles` (some more for very few): vertices in one box of a
/// grid that face the same way become one. The mesh itself if it is small enough. Its outline stays
/// where it is to within the box's size.
DrawnMesh simplified(const DrawnMesh& mesh, std::size_t most_triangles);

/// A part of the mesh, triangles `first` to `last` (not included), with the vertices these need.
/// Cheap where triangles that follow each other use vertices that do.
DrawnMesh part_of(const DrawnMesh& mesh, std::size_t first, std::size_t last);

}  // namespace palpate::viewer
