// The contour of the felt isosurface in a slice, by cutting the tetrahedra of the lattice. No Qt.
#pragma once

#include <vector>

#include "apps/viewer/slices/samples.hpp"

namespace palpate::viewer {

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

}  // namespace palpate::viewer
