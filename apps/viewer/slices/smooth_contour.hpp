// The contour of a smooth field in a slice. No Qt.
#pragma once

#include "apps/viewer/slices/contour.hpp"

namespace palpate::viewer {

/// Appends the contour of `isovalue` [data units] in these cells, each round a sample: lines that
/// are bent to within a hundredth of a sample. What lies inside a triangle of the cut and meets
/// none of its corners is not seen.
void append_smooth_contour(const SliceSamples& samples, double isovalue, const CellRange& cells,
                           std::vector<ContourPiece>& pieces);

}  // namespace palpate::viewer
