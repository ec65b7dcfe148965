// The contour of the felt isosurface in a slice, by cutting the tetrahedra of the lattice. No Qt.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "apps/viewer/slices/samples.hpp"

namespace palpate::viewer {

/// A corner of a triangle: where in the cell (0 to 1), and by how much it lies inside the solid
/// [data units].
struct Corner {
    double u = 0, v = 0, depth = 0;
};

/// The corners of a cell's face in the order in which one walks round it.
using Face = std::array<double, 4>;
inline constexpr std::array<std::array<double, 2>, 4> corner_place{
    {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

/// The corners of the cut: one in the middle, four of the square round it, four on the edges across
/// the slice, and eight on the sides of the cell, two a side.
using CellCut = std::array<Corner, 17>;

/// The cut `part` (0 to 1/2) of the distance from the face `near` to `far`, of a field that is
/// linear in the tetrahedra: each corner lies on an edge of one. Faces hold depths.
CellCut cut_of_cell(const Face& near, const Face& far, double part);

/// The corners of the triangles; those that have an area.
std::span<const std::array<std::uint8_t, 3>> triangles_at(double part);

/// Calls piece(lone, p, q) if the contour goes through the triangle: `lone` lies on the other side
/// than p and q.
template <class Piece>
void march(const Corner& a, const Corner& b, const Corner& c, const Piece& piece) {
    const bool in_a = a.depth > 0, in_b = b.depth > 0, in_c = c.depth > 0;
    if (in_a == in_b && in_b == in_c) return;
    if (in_b == in_c) {
        piece(a, b, c);
    } else if (in_a == in_c) {
        piece(b, c, a);
    } else {
        piece(c, a, b);
    }
}

/// A piece of the contour, in samples along u and v.
struct ContourPiece {
    float u0, v0, u1, v1;
};

/// The cells of a slice: those whose lower corner has u from `u0` to below `u1`, and so for v. The
/// ring of cells between data and background counts: from -1 to below the number of samples. On a
/// cubic field the sample in a cell's middle names it, and the ring goes to the number of samples.
struct CellRange {
    int u0 = -1, v0 = -1, u1 = 0, v1 = 0;
};

enum class ContourDetail : std::uint8_t {
    lattice,  ///< exactly where the proxy meets the surface; bent lines to a hundredth of a sample
    cells,    ///< two triangles a cell of the linear field: less than a sample away, an eighth of
              ///< the work
};

/// Appends the contour of `isovalue` [data units] in these cells, in no particular order. Costs
/// what the cells cost: a few nanoseconds for one without a contour.
void append_contour(const SliceSamples& samples, double isovalue, const CellRange& cells,
                    ContourDetail detail, std::vector<ContourPiece>& pieces);

/// Appends the contour of `isovalue` [data units] in these cells, each round a sample: lines that
/// are bent to within a hundredth of a sample. What lies inside a triangle of the cut and meets
/// none of its corners is not seen.
void append_smooth_contour(const SliceSamples& samples, double isovalue, const CellRange& cells,
                           std::vector<ContourPiece>& pieces);

}  // namespace palpate::viewer
