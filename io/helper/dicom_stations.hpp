// Tells DICOM slices apart that lie side by side in their plane, such as the stations of a scan of
// the whole body. Uses no library.
#pragma once

#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// Slices that are shifted by more within their plane are tilted or lie side by side [pixels].
inline constexpr double same_place_pixels = 0.05;

/// [pixels] The place of a slice within the plane of another one.
Eigen::Vector2d place_in_plane(const DicomSlice& slice, const DicomSlice& of);

/// The stations of a series, whose kinds then name them: several slices lie in one plane or nearly
/// so, but side by side. Slices of a tilted gantry do not: each of these has a plane of its own.
std::vector<DicomSeries> by_station(DicomSeries series);

}  // namespace palpate::io
