// Surfaces as meshes in arrays for graphics hardware. Cutting out the part that a finer surface
// replaces, and meshes of fewer triangles for files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "palpate/surface.hpp"
#include "palpate/volume.hpp"

namespace palpate::viewer {

/// Arrays of a triangle mesh: 3 floats a vertex, 3 indices a triangle.
struct RenderMesh {
    std::vector<float> positions;  ///< [mm, physical axes] from an origin, so that floats do
    std::vector<float> normals;    ///< unit, out of the solid
    std::vector<std::int32_t> triangles;

    std::size_t vertex_count() const { return positions.size() / 3; }
    std::size_t triangle_count() const { return triangles.size() / 3; }
};

/// Blocks of a mesh; null: there is nothing of it.
using MeshBlocks = std::vector<std::shared_ptr<const RenderMesh>>;
std::size_t triangle_count(std::span<const std::shared_ptr<const RenderMesh>> blocks);
/// All blocks as one mesh. Returns a single block itself. Null if there is no triangle.
std::shared_ptr<const RenderMesh> joined(std::span<const std::shared_ptr<const RenderMesh>> blocks);

/// A box of whole cells of a grid. It is infinite on sides at the border of the data.
struct PatchBounds {
    Geometry grid;
    /// Planes between cells, in the grid's index space.
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();

    bool operator==(const PatchBounds&) const = default;
    bool has(const Vec3& index) const {
        return (index.array() >= low.array()).all() && (index.array() <= high.array()).all();
    }
};

/// Which triangles are kept: those with their middle outside of the bounds, those with any corner
/// outside, or those with any corner inside.
enum class Keep : std::uint8_t { outside, reaching_out, reaching_in };

/// The mesh with only the triangles to be kept. The mesh itself if these are all. Null if there are
/// none. Positions are relative to the middle of the grid.
std::shared_ptr<const RenderMesh> cut(const std::shared_ptr<const RenderMesh>& mesh,
                                      const PatchBounds& bounds, Keep keep);

/// A surface that can be drawn.
struct ExtractedSurface {
    double isovalue = 0;  ///< [data units]
    /// Positions are relative to the middle of the grid. Blocks that did not change are the same
    /// objects as before, at the same index.
    MeshBlocks blocks;
    MeshBlocks moving;      ///< a coarser surface, to draw while things move
    int every = 1;          ///< made from every so many-th sample along each axis
    bool finished = false;  ///< no finer one follows
    double seconds = 0;     ///< since the work began
    /// The part of a coarser surface that this one replaces. Positions are then relative to the
    /// middle of its grid.
    std::optional<PatchBounds> part;

    /// Compares the identity of meshes, not their content.
    bool operator==(const ExtractedSurface&) const = default;
};

/// The mesh with about `most_triangles`, or more where its shape does not allow so few. A closed
/// mesh stays closed, and its vertices stay where they are: some are left out. Without normals.
/// Throws what `progress` throws. (Schroeder, Zarge and Lorensen 1992)
SurfaceMesh decimated(const SurfaceMesh& mesh, std::size_t most_triangles,
                      const std::function<void(double)>& progress);

}  // namespace palpate::viewer
