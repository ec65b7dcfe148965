// Surface: the whole isosurface of a field as one watertight triangle mesh, by marching the same
// tetrahedra that the lattice walks. For looking at and for files; the proxy never needs it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "palpate/field.hpp"

namespace palpate {

/// An oriented triangle mesh, closed unless it is that of a part: every edge has exactly two
/// triangles, which run along it in opposite directions.
struct SurfaceMesh {
    std::vector<Vec3> vertices;  ///< [mm, physical]
    /// Indices into `vertices`, counter-clockwise seen from the free side: normals point out of the
    /// solid.
    std::vector<std::array<std::uint32_t, 3>> triangles;
    bool complete = true;  ///< false if `progress` cancelled the work: then the mesh is empty
};

struct SurfaceOptions {
    /// Called about once a slice with the fraction done, in [0, 1]; returning false cancels.
    std::function<bool(double fraction)> progress;
    /// More vertices than this are an error. The default is what a 32-bit index can name; a vertex
    /// with its two triangles takes 48 bytes.
    std::uint64_t max_vertices = std::numeric_limits<std::uint32_t>::max();
    /// Only the part in these cells (by their lowest corner; -1 is the ring before the grid), cut
    /// at the border of the grid and its ring. It is open where the surface leaves the box, and
    /// fits the parts in the boxes beside it: there both have the same vertices, bit for bit.
    std::optional<SampleBox> cells = std::nullopt;
};

/// How close to the end of a tetrahedron's edge a vertex may lie, as a fraction of the edge. Data
/// equal to the isovalue would put many vertices in one place; they are held apart by this much, so
/// that the mesh stays a manifold even in a file of 32-bit floats without indices (STL). All other
/// vertices lie on the isosurface to rounding.
inline constexpr double surface_margin = 1.0 / 1024;

/// The boundary of the solid: sign * (density - isovalue) > 0 is solid, equal is free. The field
/// goes on outside the grid with its background, so bodies that the border cuts are closed there.
/// Where the background itself is solid the mesh bounds the free space instead, still with normals
/// out of the solid; it is closed all the same. The same input gives the same mesh, bit for bit.
/// Throws std::invalid_argument for an isovalue that is not finite and std::length_error past
/// max_vertices. (Corenthy et al. 2012, section 3; docs/surface.md)
SurfaceMesh extract_surface(const Field& field, double isovalue,
                            const SurfaceOptions& options = {});

/// Volume enclosed by a closed mesh [mm^3], by the divergence theorem; negative where the mesh
/// bounds the free space.
double enclosed_volume(const SurfaceMesh& mesh);

}  // namespace palpate
