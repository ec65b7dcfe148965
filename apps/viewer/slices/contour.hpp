// The contour of the felt isosurface in a slice: marching squares over points at which the felt
// field is computed. No Qt.
#pragma once

#include <vector>

#include "apps/viewer/slices/samples.hpp"

namespace palpate::viewer {

/// A piece of the contour, in samples along u and v.
struct ContourPiece {
    float u0, v0, u1, v1;
};

/// The cells of a slice: those whose lower corner has u from `u0` to below `u1`, and so for v.
/// Beside the data, two rings of cells count, in which the contour closes towards the background.
struct CellRange {
    int u0 = -2, v0 = -2, u1 = 0, v1 = 0;
};

/// Appends the contour of `isovalue` [data units] in these cells, in no particular order. Each cell
/// is divided into `parts` times `parts` squares. The felt field is exact at their corners, and the
/// contour is straight inside each half of a square. Details smaller than a square may be missing.
/// With one part, the corners have the values of the samples, on the smooth field too, so that no
/// sample is missed. A cell without a contour costs a few nanoseconds.
void append_contour(const SliceSamples& samples, double isovalue, const CellRange& cells, int parts,
                    std::vector<ContourPiece>& pieces);

}  // namespace palpate::viewer
