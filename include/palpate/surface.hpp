// Surface: the whole isosurface of a field as one watertight triangle mesh, made from the same
// tetrahedra that the lattice walks. For display and for files. The proxy does not use it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "palpate/field.hpp"

namespace palpate {

/// The intersection of an isosurface with a tetrahedron: nothing, a triangle or a plane
/// quadrilateral. Its corners lie on edges from a solid to a free corner of the tetrahedron (0 to
/// 3).
struct TetrahedronCut {
    struct Edge {
        std::uint8_t solid = 0, free = 0;
    };
    int count = 0;                ///< corners of the polygon: 0, 3 or 4
    std::array<Edge, 4> edges{};  ///< on which they lie, in order around the polygon
};
/// The cut if corner i is solid where bit i of `solid` (0 to 15) is set. The polygon runs
/// counter-clockwise seen from the free side if the corners c are right-handed:
/// det(c1 - c0, c2 - c0, c3 - c0) > 0.
constexpr TetrahedronCut cut_of(unsigned solid) {
    using Edge = TetrahedronCut::Edge;
    // Even permutations of the corners: the edges of the first one, in this order, turn
    // counter-clockwise seen from the other three.
    constexpr std::uint8_t even[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 0, 1, 3}, {3, 0, 2, 1}};
    for (const auto& n : even) {
        if (solid == 1U << n[0]) {
            return {3, {Edge{n[0], n[1]}, Edge{n[0], n[2]}, Edge{n[0], n[3]}}};
        }
        if (solid == (15U ^ 1U << n[0])) {
            return {3, {Edge{n[1], n[0]}, Edge{n[3], n[0]}, Edge{n[2], n[0]}}};
        }
    }
    constexpr std::uint8_t pairs[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                          {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};
    for (const auto& n : pairs) {
        if (solid != (1U << n[0] | 1U << n[1])) continue;
        return {4, {Edge{n[0], n[2]}, Edge{n[0], n[3]}, Edge{n[1], n[3]}, Edge{n[1], n[2]}}};
    }
    return {};
}

/// An oriented triangle mesh. Unless it shows only a part, it is closed: every edge has exactly two
/// triangles, which run along it in opposite directions.
struct SurfaceMesh {
    std::vector<Vec3> vertices;  ///< [mm, physical]
    /// Indices into `vertices`, counter-clockwise seen from the free side: normals point out of the
    /// solid.
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec3> normals;  ///< unit, one per vertex, out of the solid. Empty unless requested
    bool complete = true;       ///< false if `progress` cancelled: then the mesh is empty
};

struct SurfaceOptions {
    /// Called about once per slice with the fraction done, in [0, 1]. Returning false cancels.
    std::function<bool(double fraction)> progress;
    /// More vertices than this are an error. The default is the most that a 32-bit index can name;
    /// a vertex with its two triangles takes 48 bytes.
    std::uint64_t max_vertices = std::numeric_limits<std::uint32_t>::max();
    /// Only the part in these cells (by their lowest corner, on a cubic field by the sample in
    /// their middle; -1 is the layer of cells before the grid), clipped to surface_cells(). The
    /// mesh is open where the surface leaves the box. It fits the meshes of neighbouring boxes: at
    /// the border both have the same vertices, bit for bit.
    std::optional<SampleBox> cells = std::nullopt;
    /// [voxel, smallest spacing] On a cubic field, facets are split until the middles of their
    /// edges are within this distance of the curved surface, at most eight times. 0: they are not
    /// split. On a linear field the mesh is the exact surface.
    double tolerance = 0;
    /// Computes normals from the gradient, the same that the proxy uses. For cubic fields only.
    bool normals = false;
};

/// Least distance of a vertex from the ends of its tetrahedron's edge, as a fraction of the edge.
/// Samples equal to the isovalue would put many vertices in one place. This distance keeps them
/// apart, so that the mesh is a manifold even in a file of 32-bit floats without indices (STL). All
/// other vertices lie on the isosurface to rounding.
inline constexpr double surface_margin = 1.0 / 1024;

/// The boundary of the solid: sign * (density - isovalue) >
/// 0 is solid, equal is free. Outside the grid the field has the background's value, so bodies cut
/// by the border are closed there. If the background is solid, the mesh bounds the free space
/// instead. It is also closed, with normals out of the solid. The same input gives the same mesh,
/// bit for bit. Throws std::invalid_argument for an isovalue that is not finite and
/// std::length_error past max_vertices. (Corenthy et al. 2012, section 3; docs/surface.md)
SurfaceMesh extract_surface(const Field& field, double isovalue,
                            const SurfaceOptions& options = {});

/// All cells that a surface of the field can intersect, for SurfaceOptions::cells. In a cubic
/// field, each cell is centred at a sample and has its index.
SampleBox surface_cells(const Field& field);

/// Volume enclosed by a closed mesh [mm^3], by the divergence theorem. Negative where the mesh
/// bounds the free space.
double enclosed_volume(const SurfaceMesh& mesh);

}  // namespace palpate
