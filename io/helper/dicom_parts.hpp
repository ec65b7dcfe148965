// Divides slices of one DICOM series into those of each volume: stations, contrasts, inversion
// times, acquisitions. Uses no library.
#pragma once

#include "io/helper/dicom_slice.hpp"

namespace palpate::io {

/// The volumes of a series, whose kinds then name what tells them apart.
std::vector<DicomSeries> parts_of(DicomSeries series);

}  // namespace palpate::io
